import { Suspense, useMemo, useState } from "react";
import { useSessionAt } from "../api/history";
import type { Mount } from "../api/types";
import { Copyable } from "../components/Copyable";
import { optional } from "../components/optional";
import { ClockTime } from "../components/RelativeTime";
import { Failed, Loading } from "../components/States";
import { Pill } from "../components/Tone";
import { degreesText, fixed, whole } from "../lib/format";
import type { Tone } from "../lib/stages";
import { t } from "../text";
import fold from "./fold.module.css";
import css from "./mounts.module.css";
import { kmh, speeds } from "./verification/trace";

const TraceLines = optional(() => import("./verification/TraceLines"));

const TONE: Record<Mount["status"], Tone> = { in_force: "good", suspect: "bad", superseded: "neutral" };

/** One confirmed mounting: when, which angles, how its drive test went; the rest unfolds. */
export function MountRow({ id, mount }: { id: string; mount: Mount }) {
  const [open, setOpen] = useState(false);
  const { status, confirmed_at, angles_deg, sigma_deg } = mount;
  const [roll = "", pitch = "", yaw = ""] = sigma_deg.map(degreesText);
  return (
    <>
      <div className={css.head}>
        <b>
          <ClockTime at={confirmed_at} />
        </b>
        <Pill tone={TONE[status]}>{t(`history.mounts.${status}`)}</Pill>
      </div>
      <p className={css.angles}>
        {t("history.mounts.angles", {
          roll: `${fixed(angles_deg.roll, 1)}°`,
          pitch: `${fixed(angles_deg.pitch, 1)}°`,
          yaw: `${fixed(angles_deg.yaw, 1)}°`,
        })}
        <br />
        {t("history.mounts.sigma", { roll, pitch, yaw })}
      </p>
      <p className={css.quiet}>{testWords(mount)}</p>
      <details onToggle={(event) => setOpen(event.currentTarget.open)}>
        <summary className={fold.line}>{t("history.mounts.details", { number: mount.id })}</summary>
        {open && <Details id={id} mount={mount} />}
      </details>
    </>
  );
}

function testWords({ verification: { state, error_mps, limit_mps, elapsed_s } }: Mount): string {
  if (error_mps === null) return t("history.mounts.untested");
  return t(`history.mounts.${state === "passed" ? "passed" : "tested"}`, {
    error: kmh(error_mps),
    limit: kmh(limit_mps),
    seconds: whole(elapsed_s),
  });
}

function Details({ id, mount }: { id: string; mount: Mount }) {
  const { trace } = mount.verification;
  const drawn = useMemo(() => speeds(trace), [trace]);
  const quaternion = mount.quaternion.map((part) => part.toFixed(6)).join(", ");
  return (
    <div className={css.details}>
      {drawn && (
        <Suspense fallback={<Loading what={t("device.test.the_chart")} />}>
          <TraceLines speeds={drawn} />
        </Suspense>
      )}
      <Copyable label={t("history.mounts.quaternion")} text={quaternion} />
      <Session id={id} at={mount.confirmed_at} />
    </div>
  );
}

/** The session in which it was confirmed: the history knows. */
function Session({ id, at }: { id: string; at: string }) {
  const session = useSessionAt(id, at);
  const what = t("history.mounts.the_session");
  if (session.isPending) return <Loading what={what} lines={1} />;
  if (session.isError) return <Failed what={what} error={session.error} retry={session.refetch} />;
  if (session.data === null) return <p className={css.quiet}>{t("history.mounts.no_session")}</p>;
  return <Copyable label={t("history.mounts.session")} text={session.data} />;
}
