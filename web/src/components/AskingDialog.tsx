import { Button, Group, Modal, Stack } from "@mantine/core";
import type { FormEvent, ReactNode } from "react";
import { t } from "../text";
import css from "./asking.module.css";

export interface AskingProps {
  opened: boolean;
  onClose: () => void;
  title: string;
  /** what the button says that does it */
  go: string;
  onGo: () => void;
  pending: boolean;
  /** it cannot be done yet */
  disabled?: boolean;
  /** it cannot be undone */
  grave?: boolean;
  children: ReactNode;
}

/** A dialog that explains, asks, and does it or not. */
export default function AskingDialog({ opened, onClose, title, children, ...answers }: AskingProps) {
  return (
    <Modal
      opened={opened}
      onClose={onClose}
      title={title}
      closeButtonProps={{ "aria-label": t("common.close") }}
    >
      <Answers onClose={onClose} {...answers}>
        {children}
      </Answers>
    </Modal>
  );
}

type AnswersProps = Omit<AskingProps, "opened" | "title">;

function Answers({ onClose, go, onGo, pending, disabled = false, grave = false, children }: AnswersProps) {
  const submit = (event: FormEvent) => {
    event.preventDefault();
    onGo();
  };
  return (
    <form onSubmit={submit} className={css.asking}>
      <Stack>
        {children}
        <Group justify="flex-end">
          <Button variant="default" onClick={onClose}>
            {t("common.cancel")}
          </Button>
          <Button type="submit" loading={pending} disabled={disabled} color={grave ? "red.9" : undefined}>
            {go}
          </Button>
        </Group>
      </Stack>
    </form>
  );
}
