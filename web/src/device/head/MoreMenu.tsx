import { Button } from "@mantine/core";
import { Ellipsis, KeyRound, type LucideIcon, Pencil, Trash2 } from "lucide-react";
import { lazy, Suspense, useRef, useState } from "react";
import type { Device } from "../../api/types";
import { t } from "../../text";
import css from "./head.module.css";

const DIALOGS = {
  edit: lazy(() => import("./EditDialog")),
  new_key: lazy(() => import("./KeyDialog")),
  remove: lazy(() => import("./RemoveDialog")),
};
type Choice = keyof typeof DIALOGS;

const CHOICES: readonly { choice: Choice; icon: LucideIcon }[] = [
  { choice: "edit", icon: Pencil },
  { choice: "new_key", icon: KeyRound },
  { choice: "remove", icon: Trash2 },
];
const MORE = "more";

/** What is seldom done to a device. Each choice opens a dialog, which is made anew each time. */
export function MoreMenu({ device }: { device: Device }) {
  const [chosen, choose] = useState<Choice | null>(null);
  const button = useRef<HTMLButtonElement>(null);
  const Dialog = chosen && DIALOGS[chosen];
  const close = () => {
    choose(null);
    button.current?.focus();
  };
  return (
    <div>
      <Button
        ref={button}
        variant="default"
        className={css.action}
        aria-label={t("device.action.more")}
        title={t("device.action.more")}
        popoverTarget={MORE}
      >
        <Ellipsis size={20} aria-hidden />
      </Button>
      <Choices onChoose={choose} below={button} />
      <Suspense fallback={null}>{Dialog && <Dialog device={device} onClose={close} />}</Suspense>
    </div>
  );
}

interface ChoicesProps {
  onChoose: (choice: Choice) => void;
  below: { readonly current: HTMLElement | null };
}

/** The browser's own popover, which knows no place: it is put below the button when it opens. */
function Choices({ onChoose, below }: ChoicesProps) {
  const place = (popover: HTMLElement) => {
    const { bottom, right } = below.current?.getBoundingClientRect() ?? { bottom: 0, right: 0 };
    popover.style.top = `${scrollY + bottom}px`;
    popover.style.right = `${document.documentElement.clientWidth - right}px`;
  };
  return (
    <div
      id={MORE}
      popover="auto"
      className={css.choices}
      onBeforeToggle={({ currentTarget }) => place(currentTarget)}
    >
      {CHOICES.map(({ choice, icon: Icon }) => (
        <button
          key={choice}
          type="button"
          popoverTarget={MORE}
          popoverTargetAction="hide"
          onClick={() => onChoose(choice)}
        >
          <Icon size={18} aria-hidden />
          {t(`device.action.${choice}`)}
        </button>
      ))}
    </div>
  );
}
