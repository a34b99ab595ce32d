import { useQueryClient } from "@tanstack/react-query";
import { createContext, type ReactNode, useContext, useEffect, useState } from "react";
import { connect, type LiveStatus } from "../api/live";
import { RelativeTime } from "../components/RelativeTime";
import { Trans, t } from "../text";
import css from "./shell.module.css";

interface Liveness {
  status: LiveStatus;
  /** RFC 3339: since when it is so */
  since: string;
}

const NEW: Liveness = { status: "connecting", since: new Date().toISOString() };
const State = createContext<Liveness>(NEW);

/** Keeps everything below it live. */
export function LiveProvider({ children }: { children: ReactNode }) {
  const client = useQueryClient();
  const [liveness, setLiveness] = useState(NEW);
  useEffect(() => connect(client, (status) => setLiveness((before) => after(before, status))), [client]);
  return <State value={liveness}>{children}</State>;
}

function after(before: Liveness, status: LiveStatus): Liveness {
  return before.status === status ? before : { status, since: new Date().toISOString() };
}

/** Is what is on the screen true now? */
export function useLive(): boolean {
  return useContext(State).status === "live";
}

/** Tells whether what is on the screen is true now, and if not since when. */
export function LiveLamp() {
  const { status, since } = useContext(State);
  return (
    <span className={css.lamp} data-status={status} title={t(`shell.live.${status}`)}>
      <i aria-hidden />
      <span>
        <span role="status">{t(`shell.live.${status}`)}</span>
        {status === "reconnecting" && (
          <small>
            <Trans i18nKey="shell.lost" components={{ ago: <RelativeTime at={since} /> }} />
          </small>
        )}
      </span>
    </span>
  );
}
