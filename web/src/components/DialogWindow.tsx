import { Modal } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import type { ReactNode } from "react";
import { t } from "../text";

export interface DialogProps {
  onClose: () => void;
  title: string;
  /** it closes only by its buttons: there is something in it that is shown this once */
  stays?: boolean;
  children: ReactNode;
}

export function DialogWindow({ onClose, title, stays = false, children }: DialogProps) {
  const phone = useMediaQuery("(max-width: 36em)", false, { getInitialValueInEffect: false });
  return (
    <Modal
      opened
      onClose={onClose}
      title={title}
      fullScreen={phone}
      closeOnClickOutside={!stays}
      closeOnEscape={!stays}
      closeButtonProps={{ "aria-label": t("common.close") }}
    >
      {children}
    </Modal>
  );
}
