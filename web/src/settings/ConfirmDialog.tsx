import { Button, Group, Stack } from "@mantine/core";
import type { ReactNode } from "react";
import { Dialog } from "../components/Dialog";
import { t } from "../text";

interface ConfirmDialogProps {
  title: string;
  about: string;
  /** what the button says that does it */
  action: string;
  pending: boolean;
  onConfirm: () => void;
  onClose: () => void;
  /** what went wrong */
  children?: ReactNode;
}

/** Asks before something is done that cannot be undone. */
export function ConfirmDialog({
  title,
  about,
  action,
  pending,
  onConfirm,
  onClose,
  children,
}: ConfirmDialogProps) {
  return (
    <Dialog onClose={onClose} title={title}>
      <Stack>
        <p style={{ margin: 0 }}>{about}</p>
        {children}
        <Group justify="flex-end">
          <Button variant="default" onClick={onClose} data-autofocus>
            {t("common.cancel")}
          </Button>
          <Button color="red" loading={pending} onClick={onConfirm}>
            {action}
          </Button>
        </Group>
      </Stack>
    </Dialog>
  );
}
