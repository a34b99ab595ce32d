import { Button, Group, Stack } from "@mantine/core";
import { CircleAlert, RotateCw, Users } from "lucide-react";
import type { ReactNode } from "react";
import type { Alert } from "../api/types";
import { Notice } from "../components/Tone";
import { whole } from "../lib/format";
import { problemText } from "../lib/problem";
import { t } from "../text";
import css from "./alerts.module.css";
import type { Report } from "./settling";
import { lateText } from "./settling";
import { finding } from "./words";

interface SettleReportProps {
  report: Report;
  onAgain: (alerts: readonly Alert[]) => void;
  onClose: () => void;
}

/** What did not go as wished: what failed, to be tried again, and where somebody else was quicker. */
export function SettleReport({ report: { late, failed }, onAgain, onClose }: SettleReportProps) {
  return (
    <Stack>
      {failed.length > 0 && (
        <Notice tone="bad" icon={CircleAlert} title={counted("failed", failed.length)} role="alert">
          <Items>
            {failed.map(({ alert, error }) => (
              <Item key={alert.id} alert={alert} why={problemText(error)} />
            ))}
          </Items>
        </Notice>
      )}
      {late.length > 0 && (
        <Notice tone="warn" icon={Users} title={counted("late", late.length)} role="status">
          <Items>
            {late.map((alert) => (
              <Item key={alert.id} alert={alert} why={lateText(alert)} />
            ))}
          </Items>
        </Notice>
      )}
      <Group justify="flex-end">
        <Button variant="default" onClick={onClose}>
          {t("common.close")}
        </Button>
        {failed.length > 0 && (
          <Button
            leftSection={<RotateCw size={18} aria-hidden />}
            onClick={() => onAgain(failed.map(({ alert }) => alert))}
          >
            {t("common.try_again")}
          </Button>
        )}
      </Group>
    </Stack>
  );
}

function counted(what: "failed" | "late", count: number): string {
  return t(`alerts.settle.${what}`, { count, number: whole(count) });
}

function Items({ children }: { children: ReactNode }) {
  return <ul className={css.report}>{children}</ul>;
}

function Item({ alert, why }: { alert: Alert; why: string }) {
  return (
    <li>
      <b>{alert.device_id}</b>: {finding(alert)}
      <br />
      {why}
    </li>
  );
}
