import { Button } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { Download as DownloadIcon } from "lucide-react";
import { readEstimates } from "../../api/history";
import type { TimeRange } from "../../api/keys";
import { Failed } from "../../components/States";
import { whole } from "../../lib/format";
import { t } from "../../text";
import { csvName, csvText, save } from "./csv";
import css from "./history.module.css";
import { MOST_POINTS } from "./span";

/** The shown part of the history as a file. */
export function Download({ id, shown }: { id: string; shown: TimeRange }) {
  const download = useMutation({ mutationFn: () => fetched(id, shown) });
  const { data, error } = download;
  return (
    <>
      <Button
        size="sm"
        h={44}
        variant="default"
        leftSection={<DownloadIcon size={18} aria-hidden />}
        loading={download.isPending}
        onClick={() => download.mutate()}
      >
        {t("history.csv.download")}
      </Button>
      <div className={css.downloaded}>
        {error && <Failed what={t("history.csv.what")} error={error} retry={() => download.mutate()} />}
        <p role="status">{data && outcome(data)}</p>
      </div>
    </>
  );
}

interface Saved {
  name: string;
  rows: number;
}

async function fetched(id: string, shown: TimeRange): Promise<Saved> {
  const estimates = await readEstimates(id, shown, MOST_POINTS);
  const rows = estimates.time.length;
  if (rows === 0) return { name: "", rows };
  const name = csvName(id, estimates);
  save(name, csvText(estimates));
  return { name, rows };
}

function outcome({ name, rows }: Saved): string {
  const number = whole(rows);
  if (rows === 0) return t("history.csv.nothing");
  if (rows >= MOST_POINTS) return t("history.csv.thinned", { name, number });
  return t("history.csv.saved", { name, count: rows, number });
}
