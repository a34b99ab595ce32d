import { Button, Collapse, Group, Modal, Stack, Textarea, TextInput } from "@mantine/core";
import { useDisclosure, useMediaQuery } from "@mantine/hooks";
import { type FormEvent, useState } from "react";
import { Problem } from "../api/http";
import { useRegister } from "../api/queries";
import type { DeviceDraft } from "../api/types";
import { Failed } from "../components/States";
import { Registered } from "./Registered";

const EMPTY = { name: "", id: "", vehicle: "", notes: "" };
type Fields = typeof EMPTY;

/** Two steps in one dialog: the form, then the key, which is shown this once. */
export function RegisterDialog({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  const register = useRegister();
  const [fields, setFields] = useState(EMPTY);
  const phone = useMediaQuery("(max-width: 36em)");
  const close = () => {
    onClose();
    register.reset();
    setFields(EMPTY);
  };
  const done = register.data;
  return (
    <Modal
      opened={opened}
      onClose={close}
      title={done ? "The device is registered" : "Register a device"}
      fullScreen={phone}
      closeOnClickOutside={!done}
      closeOnEscape={!done}
    >
      {done ? (
        <Registered registered={done} onDone={close} />
      ) : (
        <Form
          fields={fields}
          onChange={setFields}
          onSubmit={() => register.mutate(draft(fields))}
          onCancel={close}
          pending={register.isPending}
          error={register.error}
        />
      )}
    </Modal>
  );
}

/** What was left empty is left out, so that the service fills it in. */
function draft(fields: Fields): DeviceDraft {
  const given = Object.entries(fields).map(([name, value]) => [name, value.trim() || null]);
  return { ...Object.fromEntries(given), name: fields.name.trim() };
}

interface FormProps {
  fields: Fields;
  onChange: (fields: Fields) => void;
  onSubmit: () => void;
  onCancel: () => void;
  pending: boolean;
  error: Error | null;
}

function Form({ fields, onChange, onSubmit, onCancel, pending, error }: FormProps) {
  const [more, { toggle }] = useDisclosure(false);
  const wrong = error instanceof Problem ? error.fields : {};
  const input = (name: keyof Fields) => ({
    value: fields[name],
    onChange: (event: { currentTarget: { value: string } }) =>
      onChange({ ...fields, [name]: event.currentTarget.value }),
    error: wrong[name],
  });
  const submit = (event: FormEvent) => {
    event.preventDefault();
    onSubmit();
  };
  const unexplained = error !== null && Object.keys(wrong).length === 0;
  return (
    <form onSubmit={submit}>
      <Stack>
        <TextInput
          label="Name"
          placeholder="Van 12"
          maxLength={128}
          required
          data-autofocus
          {...input("name")}
        />
        <TextInput label="Vehicle" placeholder="Make, model, plate" maxLength={128} {...input("vehicle")} />
        <Button variant="subtle" size="sm" w="fit-content" px="xs" onClick={toggle} aria-expanded={more}>
          {more ? "Fewer details" : "More details"}
        </Button>
        <Collapse expanded={more}>
          <Stack>
            <TextInput
              label="Device id"
              description="Letters, digits and . _ : - ; chosen for you when left empty."
              pattern="[A-Za-z0-9][A-Za-z0-9._:\-]{0,63}"
              autoCapitalize="off"
              spellCheck={false}
              {...input("id")}
            />
            <Textarea label="Notes" autosize minRows={2} maxLength={4000} {...input("notes")} />
          </Stack>
        </Collapse>
        {unexplained && <Failed what="the new device" error={error} />}
        <Group justify="flex-end" mt="xs">
          <Button variant="default" onClick={onCancel}>
            Cancel
          </Button>
          <Button type="submit" loading={pending}>
            Register
          </Button>
        </Group>
      </Stack>
    </form>
  );
}
