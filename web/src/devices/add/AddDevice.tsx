import { Modal } from "@mantine/core";
import { useMediaQuery } from "@mantine/hooks";
import { useState } from "react";
import { useRegister } from "../../api/devices";
import { t } from "../../text";
import { Added } from "./Added";
import { DeviceForm, draft, EMPTY, type Start } from "./DeviceForm";
import { Scanner } from "./Scanner";
import type { Found } from "./scannedId";

/** One dialog: a form, from which one may go to the scanner and back; then the key, which is shown this once. */
export default function AddDevice({ onClose }: { onClose: () => void }) {
  const register = useRegister();
  const [fields, setFields] = useState(EMPTY);
  const [scanned, setScanned] = useState<Found | null>(null);
  const [isScanning, setScanning] = useState(false);
  const [start, setStart] = useState<Start>("name");
  const phone = useMediaQuery("(max-width: 36em)");
  const added = register.data;
  return (
    <Modal
      opened
      onClose={onClose}
      title={title()}
      fullScreen={phone}
      closeOnClickOutside={!added}
      closeOnEscape={!added}
      transitionProps={{ duration: 0 }}
    >
      {content()}
    </Modal>
  );

  function title() {
    if (added) return t("devices.done.title");
    return isScanning ? t("devices.scan.title") : t("devices.form.title");
  }

  function content() {
    if (added) return <Added registered={added} onDone={onClose} />;
    if (isScanning) return <Scanner onFound={found} onType={() => backTo("id")} />;
    return (
      <DeviceForm
        fields={fields}
        onChange={setFields}
        scanned={scanned}
        start={start}
        onScan={() => setScanning(true)}
        onSubmit={() => register.mutate(draft(fields))}
        onCancel={onClose}
        pending={register.isPending}
        error={register.error}
      />
    );
  }

  function found(code: Found) {
    setScanned(code);
    setFields({ ...fields, id: code.id });
    backTo("scan");
  }

  function backTo(control: Start) {
    setStart(control);
    setScanning(false);
  }
}
