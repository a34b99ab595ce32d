import { Anchor } from "@mantine/core";
import { ArrowLeft, SearchX } from "lucide-react";
import { Link } from "wouter";
import { useAlert } from "../api/alerts";
import { Problem } from "../api/http";
import { Empty, Failed, Loading } from "../components/States";
import { t } from "../text";
import { AlertCard } from "./AlertCard";
import css from "./alerts.module.css";

/** One alert, unfolded. */
export function OneAlert({ id }: { id: number }) {
  return (
    <div className={css.page}>
      <div>
        <Anchor component={Link} href="/alerts" className={css.back}>
          <ArrowLeft size={18} aria-hidden />
          {t("alerts.one.all")}
        </Anchor>
        <h1>{t("shell.alerts")}</h1>
      </div>
      <Content id={id} />
    </div>
  );
}

function Content({ id }: { id: number }) {
  const alert = useAlert(id);
  if (alert.isPending) return <Loading what={t("alerts.the_alert")} />;
  if (alert.error instanceof Problem && alert.error.status === 404) return <Missing id={id} />;
  if (alert.isError) return <Failed what={t("alerts.the_alert")} error={alert.error} retry={alert.refetch} />;
  return <AlertCard alert={alert.data} showDevice unfolded />;
}

function Missing({ id }: { id: number }) {
  return (
    <div className="card">
      <Empty icon={SearchX} title={t("alerts.one.missing", { id: String(id) })}>
        <p>{t("alerts.one.missing_about")}</p>
      </Empty>
    </div>
  );
}
