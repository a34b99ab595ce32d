import { Button } from "@mantine/core";
import { useState } from "react";
import { useMounts } from "../api/mounts";
import { Section } from "../components/Section";
import { Failed, Loading } from "../components/States";
import { whole } from "../lib/format";
import { t } from "../text";
import { MountRow } from "./MountRow";
import css from "./mounts.module.css";

/** Shown before somebody asks for more. */
const FEW = 3;

/** Every mounting that was ever confirmed, newest first. */
export function MountsSection({ id }: { id: string }) {
  const mounts = useMounts(id);
  const [all, setAll] = useState(false);
  const items = mounts.data?.pages.flatMap((page) => page.items) ?? [];
  const shown = all ? items : items.slice(0, FEW);
  const hidden = items.length - shown.length;
  const what = t("history.mounts.the_mountings");
  return (
    <Section title={t("history.mounts.title")}>
      {mounts.isPending && <Loading what={what} />}
      {mounts.isError && <Failed what={what} error={mounts.error} retry={mounts.refetch} />}
      {mounts.isSuccess && items.length === 0 && <p className={css.quiet}>{t("history.mounts.none")}</p>}
      <ol className={css.mounts} reversed>
        {shown.map((mount) => (
          <li key={mount.id}>
            <MountRow id={id} mount={mount} />
          </li>
        ))}
      </ol>
      {hidden > 0 && (
        <Button variant="subtle" mt="sm" onClick={() => setAll(true)}>
          {t("history.more", { count: hidden, number: whole(hidden) })}
        </Button>
      )}
      {hidden === 0 && mounts.hasNextPage && (
        <Button
          variant="subtle"
          mt="sm"
          loading={mounts.isFetchingNextPage}
          onClick={() => mounts.fetchNextPage()}
        >
          {t("history.mounts.older")}
        </Button>
      )}
    </Section>
  );
}
