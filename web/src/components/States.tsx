import { Button, Skeleton, Stack } from "@mantine/core";
import { CircleAlert, type LucideIcon, RotateCw } from "lucide-react";
import type { ReactNode } from "react";
import { problemText } from "../lib/problem";
import { t } from "../text";
import css from "./states.module.css";
import { Notice } from "./Tone";

/** Grey bars where the content will be. They appear late, so that a quick answer does not flicker. */
export function Loading({ what, lines = 3 }: { what: string; lines?: number }) {
  return (
    <div className={css.loading} role="status" aria-label={t("common.loading", { what })}>
      <Stack gap="sm">
        {Array.from({ length: lines }, (_, line) => `${90 - 13 * (line % 4)}%`).map((width, line) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: the bars have no identity
          <Skeleton key={line} height={line === 0 ? 28 : 16} width={width} />
        ))}
      </Stack>
    </div>
  );
}

interface EmptyProps {
  icon: LucideIcon;
  title: string;
  /** h1 where this is all there is on the page */
  as?: "p" | "h1";
  children?: ReactNode;
}

export function Empty({ icon: Icon, title, as: Title = "p", children }: EmptyProps) {
  return (
    <div className={css.empty}>
      <Icon size={36} strokeWidth={1.5} aria-hidden />
      <Title className={css.emptyTitle}>{title}</Title>
      {children}
    </div>
  );
}

interface FailedProps {
  /** what could not be loaded, such as "the devices" */
  what: string;
  error: Error;
  retry?: () => void;
}

/** Something could not be loaded: why, and a way to try again. */
export function Failed({ what, error, retry }: FailedProps) {
  return <Trouble title={t("common.could_not_load", { what })} error={error} retry={retry} />;
}

interface TroubleProps {
  title: string;
  error: Error;
  retry?: (() => void) | undefined;
}

/** What went wrong, in the service's words, and a way to try again. */
export function Trouble({ title, error, retry }: TroubleProps) {
  return (
    <Notice tone="bad" icon={CircleAlert} title={title} role="alert">
      <p>{problemText(error)}</p>
      {retry && (
        <Button
          mt="sm"
          size="sm"
          variant="default"
          leftSection={<RotateCw size={16} aria-hidden />}
          onClick={retry}
        >
          {t("common.try_again")}
        </Button>
      )}
    </Notice>
  );
}
