import { Button, Group, Stack, Textarea } from "@mantine/core";
import { useState } from "react";
import { useSettle, type Verb } from "../api/alerts";
import { useSession } from "../api/session";
import type { Alert } from "../api/types";
import { Dialog } from "../components/Dialog";
import { say } from "../components/Said";
import { Bar } from "../components/Tone";
import type { Outcome } from "../lib/each";
import { whole } from "../lib/format";
import { t } from "../text";
import { SettleReport } from "./SettleReport";
import { lateText, type Report, report } from "./settling";

interface SettleDialogProps {
  alerts: readonly Alert[];
  verb: Verb;
  onClose: () => void;
}

/** Acknowledge or resolve one alert or several, with a note. It stays open while there is something to tell or to repeat. */
export function SettleDialog({ alerts, verb, onClose }: SettleDialogProps) {
  const me = useSession().data?.name ?? "";
  const settle = useSettle();
  const [note, setNote] = useState("");
  const [finished, setFinished] = useState(0);
  const judged = (outcomes: Outcomes) => report(outcomes, verb, me, note.trim());
  const tell = (outcomes: Outcomes) => {
    const after = judged(outcomes);
    say(saidText(after, verb));
    if (isTold(after)) onClose();
  };
  const run = (which: readonly Alert[]) => {
    setFinished(0);
    settle.mutate({ alerts: which, verb, note: note.trim(), onProgress: setFinished }, { onSuccess: tell });
  };
  const close = () => {
    if (!settle.isPending) onClose();
  };
  const [count, number] = [alerts.length, whole(alerts.length)];
  const running = settle.isPending ? settle.variables.alerts.length : 0;
  return (
    <Dialog onClose={close} title={t(`alerts.settle.${verb}_title`, { count, number })}>
      {settle.data ? (
        <SettleReport report={judged(settle.data)} onAgain={run} onClose={close} />
      ) : (
        <Stack>
          <p style={{ margin: 0 }}>{t(`alerts.settle.${verb}_about`)}</p>
          <Note note={note} onChange={setNote} />
          {running > 1 && <Progress finished={finished} of={running} />}
          <Group justify="flex-end">
            <Button variant="default" disabled={settle.isPending} onClick={close}>
              {t("common.cancel")}
            </Button>
            <Button loading={settle.isPending} onClick={() => run(alerts)}>
              {t(`alerts.card.${verb}`)}
            </Button>
          </Group>
        </Stack>
      )}
    </Dialog>
  );
}

type Outcomes = readonly Outcome<Alert, Alert>[];

function Note({ note, onChange }: { note: string; onChange: (note: string) => void }) {
  return (
    <Textarea
      label={t("alerts.settle.note")}
      description={t("alerts.settle.note_about")}
      autosize
      minRows={2}
      maxLength={4000}
      value={note}
      onChange={(event) => onChange(event.currentTarget.value)}
      data-autofocus
    />
  );
}

function Progress({ finished, of }: { finished: number; of: number }) {
  const text = t("alerts.settle.progress", { finished: whole(finished), number: whole(of) });
  return (
    <div>
      <p style={{ margin: "0 0 0.35rem" }}>{text}</p>
      <Bar value={finished / of} label={text} />
    </div>
  );
}

/** All is said in one sentence, so that nothing needs to stay open. */
function isTold({ done, late, failed }: Report): boolean {
  return failed.length === 0 && (late.length === 0 || done.length + late.length === 1);
}

function saidText({ done, late }: Report, verb: Verb): string {
  const [only] = late;
  if (only && late.length === 1 && done.length === 0) return lateText(only);
  if (done.length === 0) return "";
  return t(`alerts.settle.${verb}d`, { count: done.length, number: whole(done.length) });
}
