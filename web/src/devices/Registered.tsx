import { Button, Group, Stack } from "@mantine/core";
import { KeyRound } from "lucide-react";
import { Link } from "wouter";
import type { RegisteredDevice } from "../api/types";
import { Copyable } from "../components/Copyable";
import { Notice } from "../components/Tone";

interface RegisteredProps {
  registered: RegisteredDevice;
  onDone: () => void;
}

/** The key is not kept in readable form anywhere: whoever registers carries it to the device now. */
export function Registered({ registered: { device, key }, onDone }: RegisteredProps) {
  return (
    <Stack>
      <Notice tone="warn" icon={KeyRound} title="This key is shown only now">
        <p>
          Put it into the device, or keep it safe. If it is lost, remove the device and register it again.
        </p>
      </Notice>
      <Copyable label={`Key of ${device.name}`} text={key} />
      <Copyable label="Or send a recorded drive" text={uploadCommand(device.id, key, location.origin)} />
      <Group justify="flex-end">
        <Button variant="default" onClick={onDone}>
          Done
        </Button>
        <Button component={Link} href={`/devices/${encodeURIComponent(device.id)}`} onClick={onDone}>
          Open the device
        </Button>
      </Group>
    </Stack>
  );
}

/** For a shell, one option a line. */
export function uploadCommand(id: string, key: string, server: string): string {
  return [`livella upload drive.csv`, `--server ${server}`, `--device ${id}`, `--key ${key}`].join(" \\\n  ");
}
