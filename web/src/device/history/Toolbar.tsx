import { ActionIcon, Button } from "@mantine/core";
import { ChevronLeft, ChevronRight, type LucideIcon, Maximize2, ZoomIn, ZoomOut } from "lucide-react";
import { t } from "../../text";
import { Download } from "./Download";
import css from "./history.module.css";
import { moved, type Span, stretched } from "./span";
import type { TimeAxis } from "./timeAxis";
import type { HistoryWindow } from "./useWindow";

const MOVES: readonly [LucideIcon, "earlier" | "later" | "in" | "out", (span: Span) => Span][] = [
  [ChevronLeft, "earlier", (span) => moved(span, -0.5)],
  [ChevronRight, "later", (span) => moved(span, 0.5)],
  [ZoomIn, "in", (span) => stretched(span, 0.5)],
  [ZoomOut, "out", (span) => stretched(span, 2)],
];

/** What wheel and fingers do, for the keyboard; and the data to take away. */
export function Toolbar({ id, window: { time, view, reset, shown } }: { id: string; window: HistoryWindow }) {
  return (
    <div className={css.toolbar}>
      {/* biome-ignore lint/a11y/useSemanticElements: a fieldset would be a form's */}
      <div role="group" aria-label={t("history.move.label")} className={css.moves}>
        {MOVES.map(([Icon, name, to]) => (
          <ActionIcon
            key={name}
            variant="default"
            aria-label={t(`history.move.${name}`)}
            onClick={() => go(time, to)}
          >
            <Icon size={20} aria-hidden />
          </ActionIcon>
        ))}
        {view && (
          <Button
            size="sm"
            h={44}
            variant="light"
            leftSection={<Maximize2 size={18} aria-hidden />}
            onClick={reset}
          >
            {t("history.move.reset")}
          </Button>
        )}
      </div>
      <Download id={id} shown={shown} />
    </div>
  );
}

function go(time: TimeAxis, to: (span: Span) => Span): void {
  const span = time.span;
  if (span) time.look(to(span));
}
