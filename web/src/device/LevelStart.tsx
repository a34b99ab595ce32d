import { Button, Group, Modal, Stack } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { CircleAlert, CircleCheckBig, SquareParking } from "lucide-react";
import { useLevelStart } from "../api/queries";
import { Notice } from "../components/Tone";
import css from "./stage.module.css";

/** A short cut for whoever stands beside the vehicle: on level ground gravity alone shows how the device is tilted. */
export function LevelStart({ id }: { id: string }) {
  const [opened, dialog] = useDisclosure(false);
  const level = useLevelStart(id);
  const open = () => {
    level.reset();
    dialog.open();
  };
  return (
    <div className={css.level}>
      <Button
        variant="default"
        maw="100%"
        h="auto"
        mih="2.75rem"
        styles={{ label: { whiteSpace: "normal" } }}
        leftSection={<SquareParking size={20} aria-hidden />}
        onClick={open}
      >
        Vehicle stands on level ground
      </Button>
      {level.isSuccess && <Taken />}
      <Modal opened={opened} onClose={dialog.close} title="Does the vehicle stand on level ground?">
        <Stack>
          <p style={{ margin: 0 }}>
            On level ground gravity shows at once how the device is tilted. Which way it faces still needs
            braking or a turn. Say so only while the vehicle stands still on a level floor, with nobody
            getting in or out.
          </p>
          {level.error && <Refused why={level.error.message} />}
          <Group justify="flex-end">
            <Button variant="default" onClick={dialog.close}>
              Cancel
            </Button>
            <Button
              loading={level.isPending}
              onClick={() => level.mutate(undefined, { onSuccess: dialog.close })}
            >
              It stands level
            </Button>
          </Group>
        </Stack>
      </Modal>
    </div>
  );
}

function Taken() {
  return (
    <Notice tone="good" icon={CircleCheckBig} title="Level ground was taken into account" role="status">
      <p>Drive off now, brake and take a turn.</p>
    </Notice>
  );
}

function Refused({ why }: { why: string }) {
  return (
    <Notice tone="bad" icon={CircleAlert} title="This was not taken" role="alert">
      <p>{why}</p>
    </Notice>
  );
}
