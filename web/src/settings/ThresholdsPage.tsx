import { useThresholds } from "../api/service";
import type { Threshold } from "../api/types";
import { Failed, Loading } from "../components/States";
import { t } from "../text";
import css from "./settings.module.css";
import { valueText } from "./thresholds";

/** What the service decides by, to be read. */
export function ThresholdsPage() {
  const thresholds = useThresholds();
  return (
    <>
      <p>{t("settings.thresholds.about")}</p>
      {thresholds.isPending && <Loading what={t("settings.thresholds.the_thresholds")} lines={8} />}
      {thresholds.isError && (
        <Failed
          what={t("settings.thresholds.the_thresholds")}
          error={thresholds.error}
          retry={thresholds.refetch}
        />
      )}
      {thresholds.data?.length === 0 && <p className={css.quiet}>{t("settings.thresholds.none")}</p>}
      {thresholds.data &&
        groups(thresholds.data).map((group) => <Group key={group} name={group} of={thresholds.data} />)}
    </>
  );
}

/** In the order of the service. */
function groups(of: readonly Threshold[]): Threshold["group"][] {
  return [...new Set(of.map(({ group }) => group))];
}

function Group({ name, of }: { name: Threshold["group"]; of: readonly Threshold[] }) {
  const items = of.filter(({ group }) => group === name);
  return (
    <div className="card">
      <table className={css.table}>
        <caption>{t(`settings.thresholds.group.${name}`)}</caption>
        <thead>
          <tr>
            <th scope="col">{t("settings.thresholds.name")}</th>
            <th scope="col">{t("settings.thresholds.value")}</th>
            <th scope="col">{t("settings.thresholds.meaning")}</th>
          </tr>
        </thead>
        <tbody>
          {items.map((item) => (
            <tr key={item.name}>
              <th scope="row">
                <code>{item.name}</code>
              </th>
              <td>{valueText(item)}</td>
              <td lang="en">{meaning(item)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** Names stand between `backticks`. */
function meaning({ meaning: text, name }: Threshold) {
  const parts = text.split("`");
  // biome-ignore lint/suspicious/noArrayIndexKey: the parts of a sentence stay where they are
  return parts.map((part, i) => (i % 2 ? <code key={`${name} ${i}`}>{part}</code> : part));
}
