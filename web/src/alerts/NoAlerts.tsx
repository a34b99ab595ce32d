import { Anchor, Button } from "@mantine/core";
import { BellOff, CircleCheckBig } from "lucide-react";
import { Link } from "wouter";
import type { AlertFilter } from "../api/keys";
import { Empty } from "../components/States";
import { Trans, t } from "../text";
import { toAddress } from "./filters";

/** Nothing to show: because all is well, or because nothing matches. */
export function NoAlerts({ filter, onClear }: { filter: AlertFilter; onClear: () => void }) {
  const usual = toAddress(filter).size === 0;
  return (
    <div className="card" role="status">
      {usual ? <AllWell /> : <NoMatch onClear={onClear} />}
    </div>
  );
}

function NoMatch({ onClear }: { onClear: () => void }) {
  return (
    <Empty icon={BellOff} title={t("alerts.empty.no_match")}>
      <Button variant="default" onClick={onClear}>
        {t("alerts.empty.show_all")}
      </Button>
    </Empty>
  );
}

function AllWell() {
  const webhooks = <Anchor component={Link} href="/settings/webhooks" underline="always" />;
  return (
    <Empty icon={CircleCheckBig} title={t("alerts.empty.good")}>
      <p>{t("alerts.empty.about")}</p>
      <p>
        <Trans i18nKey="alerts.empty.told" components={{ a: webhooks }} />
      </p>
    </Empty>
  );
}
