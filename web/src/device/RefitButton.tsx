import { Button, Group, Modal, Stack } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { RotateCcw } from "lucide-react";
import { useRestart } from "../api/queries";
import { Failed } from "../components/States";
import { HeadAction } from "./HeadAction";

/** Start again after the device was deliberately fitted elsewhere. Asks first: the mounting in force ends with it. */
export function RefitButton({ id }: { id: string }) {
  const [opened, dialog] = useDisclosure(false);
  const restart = useRestart(id);
  const close = () => {
    dialog.close();
    restart.reset();
  };
  return (
    <>
      <HeadAction icon={RotateCcw} label="Device refitted" onClick={dialog.open} />
      <Modal opened={opened} onClose={close} title="Was the device fitted anew?">
        <Stack>
          <p style={{ margin: 0 }}>
            The mounting known so far is no longer used, and the calibration begins again with the next drive.
            Earlier mountings stay in the history.
          </p>
          {restart.error && <Failed what="the new start" error={restart.error} />}
          <Group justify="flex-end">
            <Button variant="default" onClick={close}>
              Cancel
            </Button>
            <Button
              loading={restart.isPending}
              onClick={() => restart.mutate(undefined, { onSuccess: close })}
            >
              Start again
            </Button>
          </Group>
        </Stack>
      </Modal>
    </>
  );
}
