import { Anchor, NativeSelect, TextInput } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useState } from "react";
import { Link } from "wouter";
import { useAudit } from "../api/audit";
import type { AuditFilter } from "../api/keys";
import type { AuditEntry } from "../api/types";
import { ClockTime } from "../components/RelativeTime";
import { Failed, Loading } from "../components/States";
import { Trans, t } from "../text";
import { ACTIONS, actionText, detailRows, placeOf } from "./audit";
import { More } from "./More";
import css from "./settings.module.css";

const EVERYTHING: AuditFilter = { actor: "", action: "", target: "" };

/** Who did what, and when. */
export function AuditPage() {
  const [filter, setFilter] = useState(EVERYTHING);
  const [wanted] = useDebouncedValue(trimmed(filter), 250);
  return (
    <>
      <p>{t("settings.audit.about")}</p>
      <Filters filter={filter} onChange={setFilter} />
      <Entries filter={wanted} />
    </>
  );
}

function trimmed({ actor, action, target }: AuditFilter): AuditFilter {
  return { actor: actor.trim(), action, target: target.trim() };
}

interface FiltersProps {
  filter: AuditFilter;
  onChange: (filter: AuditFilter) => void;
}

function Filters({ filter, onChange }: FiltersProps) {
  const input = (name: keyof AuditFilter) => ({
    value: filter[name],
    onChange: (event: { currentTarget: { value: string } }) =>
      onChange({ ...filter, [name]: event.currentTarget.value }),
  });
  const actions = ACTIONS.map((value) => ({ value, label: actionText(value) }));
  return (
    <search className={css.filters}>
      <NativeSelect
        size="md"
        label={t("settings.audit.action")}
        data={[{ value: "", label: t("settings.audit.every_action") }, ...actions]}
        {...input("action")}
      />
      <TextInput
        label={t("settings.audit.actor")}
        placeholder={t("settings.audit.actor_hint")}
        maxLength={128}
        {...input("actor")}
      />
      <TextInput
        label={t("settings.audit.target")}
        placeholder={t("settings.audit.target_hint")}
        maxLength={128}
        {...input("target")}
      />
    </search>
  );
}

function Entries({ filter }: { filter: AuditFilter }) {
  const list = useAudit(filter);
  if (list.isPending) return <Loading what={t("settings.audit.the_trail")} lines={8} />;
  if (list.isError)
    return <Failed what={t("settings.audit.the_trail")} error={list.error} retry={list.refetch} />;
  if (list.data.length === 0) {
    return (
      <p className={css.quiet} role="status">
        {t("settings.audit.none")}
      </p>
    );
  }
  return (
    <>
      <ol className={css.list} aria-label={t("settings.audit.list")} aria-busy={list.isPlaceholderData}>
        {list.data.map((entry) => (
          <li key={entry.id} className={css.row}>
            <Entry entry={entry} />
          </li>
        ))}
      </ol>
      <More list={list} />
    </>
  );
}

function Entry({ entry }: { entry: AuditEntry }) {
  const { actor, role, action, target, at } = entry;
  const roleWord = role === "none" ? t("settings.audit.without_key") : t(`shell.role.${role}`);
  return (
    <div>
      <p className={css.title}>
        <strong>{actionText(action)}</strong>
        {target && <Target target={target} />}
      </p>
      <p className={css.facts}>
        <ClockTime at={at} />
        <span>
          <Trans
            i18nKey="settings.audit.by"
            values={{ role: roleWord }}
            components={{ who: <b>{actor}</b> }}
          />
        </span>
        {detailRows(entry).map(({ name, text }) => (
          <span key={name} lang="en">
            {name}: {text}
          </span>
        ))}
      </p>
    </div>
  );
}

function Target({ target }: { target: string }) {
  const place = placeOf(target);
  if (place === null) return <span>{target}</span>;
  return (
    <Anchor component={Link} href={place} underline="always">
      {target}
    </Anchor>
  );
}
