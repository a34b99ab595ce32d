import { Modal } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import type { ReactNode } from "react";
import { t } from "../text";

interface DialogProps {
  opened: boolean;
  onClose: () => void;
  title: string;
  /** it closes only by its buttons: there is something in it that is shown this once */
  stays?: boolean;
  children: ReactNode;
}

/** A dialog in the middle of a desk's screen, all over a phone's. */
export function Dialog({ opened, onClose, title, stays = false, children }: DialogProps) {
  const phone = useMediaQuery("(max-width: 36em)", false, { getInitialValueInEffect: false });
  return (
    <Modal
      opened={opened}
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
