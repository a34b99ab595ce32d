import { Button } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { CircleCheckBig, SquareParking } from "lucide-react";
import { useLevelStart } from "../../api/queries";
import { Asking } from "../../components/Asking";
import { Trouble } from "../../components/States";
import { Notice } from "../../components/Tone";
import { t } from "../../text";
import css from "./live.module.css";

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
        {t("device.level.offer")}
      </Button>
      {level.isSuccess && <Taken />}
      <Asking
        opened={opened}
        onClose={dialog.close}
        title={t("device.level.ask")}
        go={t("device.level.yes")}
        onGo={() => level.mutate(undefined, { onSuccess: dialog.close })}
        pending={level.isPending}
      >
        <p>{t("device.level.about")}</p>
        {level.error && <Trouble title={t("device.level.refused")} error={level.error} />}
      </Asking>
    </div>
  );
}

function Taken() {
  return (
    <Notice tone="good" icon={CircleCheckBig} title={t("device.level.taken")} role="status">
      <p>{t("device.level.taken_next")}</p>
    </Notice>
  );
}
