import { useDisclosure } from "@mantine/hooks";
import { RotateCcw } from "lucide-react";
import { useRestart } from "../../api/queries";
import { Asking } from "../../components/Asking";
import { Trouble } from "../../components/States";
import { t } from "../../text";
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
      <HeadAction icon={RotateCcw} label={t("device.action.refit")} onClick={dialog.open} />
      <Asking
        opened={opened}
        onClose={close}
        title={t("device.refit.ask")}
        go={t("device.refit.go")}
        onGo={() => restart.mutate(undefined, { onSuccess: close })}
        pending={restart.isPending}
      >
        <p>{t("device.refit.begins")}</p>
        <p>{t("device.refit.stays")}</p>
        {restart.error && <Trouble title={t("device.refit.failed")} error={restart.error} />}
      </Asking>
    </>
  );
}
