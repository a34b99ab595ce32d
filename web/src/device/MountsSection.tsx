import { useMounts } from "../api/queries";
import type { Mount } from "../api/types";
import { ClockTime } from "../components/RelativeTime";
import { Section } from "../components/Section";
import { Failed, Loading } from "../components/States";
import { Pill } from "../components/Tone";
import { fixed } from "../lib/format";
import type { Tone } from "../lib/stages";
import css from "./device.module.css";

const STATUS: Record<Mount["status"], { word: string; tone: Tone }> = {
  in_force: { word: "In force", tone: "good" },
  suspect: { word: "Suspect", tone: "bad" },
  superseded: { word: "Superseded", tone: "neutral" },
};

/** Every mounting that was ever confirmed, newest first. */
export function MountsSection({ id }: { id: string }) {
  const mounts = useMounts(id);
  return (
    <Section title="Confirmed mountings">
      {mounts.isPending && <Loading what="the mountings" />}
      {mounts.isError && <Failed what="the mountings" error={mounts.error} retry={mounts.refetch} />}
      {mounts.data?.items.length === 0 && <p className={css.quiet}>None so far.</p>}
      <ol className={css.mounts} reversed>
        {mounts.data?.items.map((mount) => (
          <li key={mount.id}>
            <MountRow mount={mount} />
          </li>
        ))}
      </ol>
    </Section>
  );
}

function MountRow({ mount }: { mount: Mount }) {
  const { word, tone } = STATUS[mount.status];
  const { roll, pitch, yaw } = mount.angles_deg;
  const error = mount.verification.error_mps;
  return (
    <>
      <div className={css.mountHead}>
        <b>
          <ClockTime at={mount.confirmed_at} />
        </b>
        <Pill tone={tone}>{word}</Pill>
      </div>
      <div className={css.quiet}>
        Roll {fixed(roll, 1)}°, pitch {fixed(pitch, 1)}°, yaw {fixed(yaw, 1)}°
        {error !== null && ` · drive test ${Math.abs(error).toFixed(1)} m/s`}
      </div>
    </>
  );
}
