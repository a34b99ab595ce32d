import { SegmentedControl } from "@mantine/core";
import { Inbox } from "lucide-react";
import { useState } from "react";
import { useHealth } from "../../api/health";
import type { Reception } from "../../api/types";
import { Copyable } from "../../components/Copyable";
import { Section } from "../../components/Section";
import { Empty, Failed, Loading } from "../../components/States";
import { t } from "../../text";
import { PERIODS, type Period } from "./health";
import css from "./health.module.css";
import { Lost } from "./Lost";
import { Numbers } from "./Numbers";
import { Rates } from "./Rates";
import { Rejected } from "./Rejected";
import { Sessions } from "./Sessions";
import { Verdict } from "./Verdict";

/** What became of the data of this device: what came in, what was not used and why, what was lost. */
export default function HealthSection({ id }: { id: string }) {
  const [period, setPeriod] = useState<Period>(24);
  return (
    <Section
      title={t("history.health.title")}
      aside={<Periods chosen={period} choose={setPeriod} />}
      className="no-print"
    >
      <div className={css.all}>
        <Health id={id} period={period} />
        <Copyable label={t("history.health.device_id")} text={id} />
      </div>
    </Section>
  );
}

function Periods({ chosen, choose }: { chosen: Period; choose: (period: Period) => void }) {
  const data = PERIODS.map((hours) => ({
    value: String(hours),
    label: (
      <>
        <span aria-hidden>{t(`history.health.hours_${hours}.short`)}</span>
        <span className="visually-hidden">{t(`history.health.hours_${hours}.long`)}</span>
      </>
    ),
  }));
  return (
    <SegmentedControl
      aria-label={t("history.health.span")}
      data={data}
      value={String(chosen)}
      onChange={(value) => choose(Number(value) as Period)}
    />
  );
}

function Health({ id, period }: { id: string; period: Period }) {
  const health = useHealth(id, period);
  const what = t("history.health.the_health");
  if (health.isError) return <Failed what={what} error={health.error} retry={health.refetch} />;
  if (!health.data) return <Loading what={what} lines={8} />;
  if (health.data.chunks === 0 && health.data.waiting === 0) {
    return (
      <Empty icon={Inbox} title={t("history.health.nothing")}>
        {t("history.health.nothing_do")}
      </Empty>
    );
  }
  return <Told health={health.data} period={period} />;
}

function Told({ health, period }: { health: Reception; period: Period }) {
  return (
    <>
      <Verdict health={health} period={period} />
      <Numbers health={health} />
      <Rates health={health} />
      <Rejected health={health} />
      <Lost health={health} />
      <Sessions health={health} />
    </>
  );
}
