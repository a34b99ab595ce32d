import { Button, Group, Stack } from "@mantine/core";
import { KeyRound } from "lucide-react";
import type { ReactNode } from "react";
import { Copyable } from "../components/Copyable";
import { Notice } from "../components/Tone";
import { t } from "../text";

interface OnceProps {
  title: string;
  about: string;
  label: string;
  secret: string;
  onDone: () => void;
  children?: ReactNode;
}

/** A secret that the service shows this once. */
export function Once({ title, about, label, secret, onDone, children }: OnceProps) {
  return (
    <Stack>
      <Notice tone="warn" icon={KeyRound} title={title}>
        <p>{about}</p>
      </Notice>
      <Copyable label={label} text={secret} />
      {children}
      <Group justify="flex-end">
        <Button onClick={onDone}>{t("common.done")}</Button>
      </Group>
    </Stack>
  );
}
