import { Anchor, Button } from "@mantine/core";
import { CalendarX, Plus } from "lucide-react";
import { useState } from "react";
import { Link } from "wouter";
import { useAccessKeys, useRevokeKey } from "../api/accessKeys";
import { Problem } from "../api/http";
import type { Key } from "../api/types";
import { ClockTime, RelativeTime } from "../components/RelativeTime";
import { say } from "../components/Said";
import { Failed, Loading, Trouble } from "../components/States";
import { Pill } from "../components/Tone";
import { Trans, t } from "../text";
import { ConfirmDialog } from "./ConfirmDialog";
import { KeyDialog } from "./KeyDialog";
import { More } from "./More";
import css from "./settings.module.css";

/** Who and what may enter. */
export function KeysPage() {
  const [making, setMaking] = useState(false);
  return (
    <>
      <div className={css.head}>
        <p>{t("settings.keys.about")}</p>
        <Button leftSection={<Plus size={20} aria-hidden />} onClick={() => setMaking(true)}>
          {t("settings.keys.make")}
        </Button>
      </div>
      <Keys />
      {making && <KeyDialog onClose={() => setMaking(false)} />}
    </>
  );
}

function Keys() {
  const list = useAccessKeys();
  const [revoking, setRevoking] = useState<Key | null>(null);
  if (list.isPending) return <Loading what={t("settings.keys.the_keys")} lines={5} />;
  if (list.isError)
    return <Failed what={t("settings.keys.the_keys")} error={list.error} retry={list.refetch} />;
  return (
    <>
      <ul className={css.list} aria-label={t("settings.keys.list")}>
        {list.data.map((key) => (
          <li key={key.id} className={css.row}>
            <KeyRow entry={key} />
            <Button variant="default" onClick={() => setRevoking(key)}>
              {t("settings.keys.revoke")}
            </Button>
          </li>
        ))}
      </ul>
      <More list={list} />
      {revoking && <RevokeDialog entry={revoking} onClose={() => setRevoking(null)} />}
    </>
  );
}

function KeyRow({ entry }: { entry: Key }) {
  return (
    <div>
      <p className={css.title}>
        <strong>{entry.name}</strong>
        <Pill tone="neutral">{t(`shell.role.${entry.role}`)}</Pill>
        {isOver(entry) && (
          <Pill tone="bad" icon={CalendarX}>
            {t("settings.keys.expired")}
          </Pill>
        )}
      </p>
      <p className={css.facts}>
        {entry.device_id !== null && <OfDevice id={entry.device_id} />}
        <Beginning prefix={entry.prefix} />
        <Made at={entry.created_at} by={entry.created_by} />
        <LastUsed at={entry.last_used_at} />
        {entry.expires_at && (
          <span>
            <Trans
              i18nKey="settings.keys.expires_at"
              components={{ when: <ClockTime at={entry.expires_at} /> }}
            />
          </span>
        )}
      </p>
    </div>
  );
}

function isOver({ expires_at }: Key): boolean {
  return expires_at !== null && Date.parse(expires_at) <= Date.now();
}

function OfDevice({ id }: { id: string }) {
  const device = (
    <Anchor component={Link} href={`/devices/${encodeURIComponent(id)}`} underline="always">
      {id}
    </Anchor>
  );
  return (
    <span>
      <Trans i18nKey="settings.keys.of_device" components={{ device }} />
    </span>
  );
}

function Beginning({ prefix }: { prefix: string | null }) {
  if (prefix === null) return <span>{t("settings.keys.unknown_beginning")}</span>;
  return (
    <span>
      <Trans i18nKey="settings.keys.begins" components={{ code: <code>{prefix}</code> }} />
    </span>
  );
}

function Made({ at, by }: { at: string; by: string | null }) {
  const components = { when: <RelativeTime at={at} />, who: <b>{by}</b> };
  return (
    <span>
      <Trans i18nKey={by ? "settings.keys.created_by" : "settings.keys.created"} components={components} />
    </span>
  );
}

function LastUsed({ at }: { at: string | null }) {
  if (at === null) return <span>{t("settings.keys.never_used")}</span>;
  return (
    <span>
      <Trans i18nKey="settings.keys.last_used" components={{ when: <RelativeTime at={at} /> }} />
    </span>
  );
}

function RevokeDialog({ entry: { id, name }, onClose }: { entry: Key; onClose: () => void }) {
  const revoke = useRevokeKey();
  const done = () => {
    say(t("settings.keys.revoked", { name }));
    onClose();
  };
  return (
    <ConfirmDialog
      title={t("settings.keys.revoke_title", { name })}
      about={t("settings.keys.revoke_about")}
      action={t("settings.keys.revoke")}
      pending={revoke.isPending}
      onConfirm={() => revoke.mutate(id, { onSuccess: done })}
      onClose={onClose}
    >
      {revoke.error && (
        <Trouble title={t("settings.keys.could_not_revoke")} error={explained(revoke.error)} />
      )}
    </ConfirmDialog>
  );
}

/** The one conflict there is: nobody could administer afterwards. */
function explained(error: Error): Error {
  const isLast = error instanceof Problem && error.status === 409;
  return isLast ? new Error(t("settings.keys.last_admin")) : error;
}
