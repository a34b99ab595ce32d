import type { Device, Installation } from "../api/types";
import { Logo } from "../app/Logo";
import { ClockTime } from "../components/RelativeTime";
import { fixed } from "../lib/format";
import { stageWord } from "../lib/stages";
import { describe } from "../lib/words";
import { MatrixTable } from "./NumbersSection";
import { Drawings } from "./picture/Drawings";
import css from "./record.module.css";
import { type Shown, shownMounting } from "./shown";

interface RecordProps {
  name: string;
  device: Device | undefined;
  installation: Installation;
}

/** The installation record: one printed page for the vehicle's file. On the screen it is not shown. */
export function Record({ name, device, installation }: RecordProps) {
  const shown = shownMounting(installation);
  return (
    <article className={`${css.record} only-print`} data-mantine-color-scheme="light">
      <header>
        <h1>Installation record</h1>
        <span>
          <Logo size={22} /> Livella
        </span>
      </header>
      <Facts name={name} device={device} installation={installation} />
      {shown ? <Mounting shown={shown} /> : <p>No mounting is known yet.</p>}
      <footer>
        <span>Installed by</span>
        <span>Date and signature</span>
      </footer>
    </article>
  );
}

function Facts({ name, device, installation }: RecordProps) {
  const { stage, mount, last_data_at } = installation;
  const verification = mount?.verification;
  return (
    <dl className={css.facts}>
      <Fact term="Device">
        {name} ({installation.device_id})
      </Fact>
      <Fact term="Vehicle">{device?.vehicle ?? "–"}</Fact>
      <Fact term="Stage">
        {mount?.status === "suspect" ? "Suspect: the device seems to have moved" : stageWord(stage)}
      </Fact>
      <Fact term="Confirmed">{mount ? <ClockTime at={mount.confirmed_at} /> : "not yet"}</Fact>
      <Fact term="Drive test">
        {verification?.error_mps != null
          ? `${verification.state}: ${Math.abs(verification.error_mps).toFixed(2)} m/s after ${Math.round(verification.duration_s)} s, limit ${verification.limit_mps} m/s`
          : "–"}
      </Fact>
      <Fact term="Last data">{last_data_at ? <ClockTime at={last_data_at} /> : "–"}</Fact>
      {device?.notes && <Fact term="Notes">{device.notes}</Fact>}
    </dl>
  );
}

function Fact({ term, children }: { term: string; children: React.ReactNode }) {
  return (
    <div>
      <dt>{term}</dt>
      <dd>{children}</dd>
    </div>
  );
}

function Mounting({ shown }: { shown: Shown }) {
  const words = describe(shown.quaternion);
  const { roll, pitch, yaw } = shown.angles;
  const rows = [
    ["Roll", roll, shown.sigma[0]],
    ["Pitch", pitch, shown.sigma[1]],
    ["Yaw", yaw, shown.sigma[2]],
  ] as const;
  return (
    <>
      <h2>{shown.mount ? "Mounting" : "Mounting so far, not confirmed"}</h2>
      <p>
        {words.turned} {words.axes}
      </p>
      <Drawings quaternion={shown.quaternion} />
      <div className={css.tables}>
        <table>
          <caption>Angles, degrees (ISO 8855)</caption>
          <tbody>
            {rows.map(([word, degrees, sigma]) => (
              <tr key={word}>
                <th scope="row">{word}</th>
                <td>{fixed(degrees, 2)}</td>
                <td>± {sigma.toFixed(2)}</td>
              </tr>
            ))}
          </tbody>
        </table>
        <MatrixTable matrix={shown.matrix} />
      </div>
      <p className={css.quaternion}>
        Quaternion q_vs (w, x, y, z): {shown.quaternion.map((value) => value.toFixed(6)).join(", ")}
      </p>
    </>
  );
}
