import { Button, Menu } from "@mantine/core";
import { Ellipsis, KeyRound, Pencil, Trash2 } from "lucide-react";
import { lazy, Suspense, useRef, useState } from "react";
import type { Device } from "../../api/types";
import { t } from "../../text";
import css from "./head.module.css";

const DIALOGS = {
  edit: lazy(() => import("./EditDialog")),
  key: lazy(() => import("./KeyDialog")),
  remove: lazy(() => import("./RemoveDialog")),
};

/** What is seldom done to a device. Each choice opens a dialog, which is made anew each time. */
export function MoreMenu({ device }: { device: Device }) {
  const [chosen, choose] = useState<keyof typeof DIALOGS | null>(null);
  const Dialog = chosen && DIALOGS[chosen];
  const button = useRef<HTMLButtonElement>(null);
  const close = () => {
    choose(null);
    button.current?.focus();
  };
  return (
    <>
      <Menu position="bottom-end" withinPortal={false}>
        <Menu.Target>
          <Button
            ref={button}
            variant="default"
            className={css.action}
            aria-label={t("device.action.more")}
            title={t("device.action.more")}
          >
            <Ellipsis size={20} aria-hidden />
          </Button>
        </Menu.Target>
        <Menu.Dropdown className={css.menu}>
          <Menu.Item leftSection={<Pencil size={18} aria-hidden />} onClick={() => choose("edit")}>
            {t("device.action.edit")}
          </Menu.Item>
          <Menu.Item leftSection={<KeyRound size={18} aria-hidden />} onClick={() => choose("key")}>
            {t("device.action.new_key")}
          </Menu.Item>
          <Menu.Item leftSection={<Trash2 size={18} aria-hidden />} onClick={() => choose("remove")}>
            {t("device.action.remove")}
          </Menu.Item>
        </Menu.Dropdown>
      </Menu>
      <Suspense fallback={null}>{Dialog && <Dialog device={device} onClose={close} />}</Suspense>
    </>
  );
}
