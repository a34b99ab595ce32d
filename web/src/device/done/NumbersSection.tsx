import { Copyable } from "../../components/Copyable";
import { Section } from "../../components/Section";
import { fixed } from "../../lib/format";
import { t } from "../../text";
import { quaternionText, type Shown } from "../shown";
import css from "./done.module.css";

/** The same mounting for those who compute with it. */
export function NumbersSection({ shown }: { shown: Shown }) {
  return (
    <Section title={t("device.numbers.title")} className="no-print">
      <div className={css.numbers}>
        <div>
          <Copyable label={t("device.numbers.quaternion")} text={quaternionText(shown.quaternion)} />
          <p className={css.note}>{t("device.numbers.note")}</p>
        </div>
        <MatrixTable matrix={shown.matrix} />
      </div>
    </Section>
  );
}

export function MatrixTable({ matrix }: { matrix: Shown["matrix"] }) {
  const words = [t("device.numbers.forward"), t("device.numbers.left"), t("device.numbers.up")];
  return (
    <table className={css.matrix}>
      <caption>{t("device.numbers.matrix")}</caption>
      <thead>
        <tr>
          <td />
          {["x", "y", "z"].map((axis) => (
            <th key={axis} scope="col">
              {t("device.numbers.of_device", { axis })}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {words.map((word, row) => (
          <tr key={word}>
            <th scope="row">{word}</th>
            {matrix[row]?.map((value, column) => (
              // biome-ignore lint/suspicious/noArrayIndexKey: a matrix's columns are their places
              <td key={column}>{fixed(value, 4)}</td>
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  );
}
