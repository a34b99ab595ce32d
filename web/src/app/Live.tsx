import { useQueryClient } from "@tanstack/react-query";
import { createContext, type ReactNode, useContext, useEffect, useState } from "react";
import { connect, type LiveStatus } from "../api/live";
import css from "./shell.module.css";

const Status = createContext<LiveStatus>("connecting");

/** Keeps everything below it live. */
export function LiveProvider({ children }: { children: ReactNode }) {
  const client = useQueryClient();
  const [status, setStatus] = useState<LiveStatus>("connecting");
  useEffect(() => connect(client, setStatus), [client]);
  return <Status value={status}>{children}</Status>;
}

const WORDS: Record<LiveStatus, string> = {
  connecting: "Connecting…",
  live: "Live",
  reconnecting: "Connection lost, trying again…",
};

/** Tells whether what is on the screen is true now. */
export function LiveLamp() {
  const status = useContext(Status);
  return (
    <span className={css.lamp} data-status={status} role="status">
      <i aria-hidden />
      {WORDS[status]}
    </span>
  );
}
