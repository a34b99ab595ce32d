import { Copyable } from "../components/Copyable";
import { Section } from "../components/Section";
import { fixed } from "../lib/format";
import css from "./device.module.css";
import type { Shown } from "./shown";

/** The same mounting for those who compute with it. */
export function NumbersSection({ shown }: { shown: Shown }) {
  const quaternion = shown.quaternion.map((value) => value.toFixed(6)).join(", ");
  return (
    <Section title="Numbers" className="no-print">
      <div className={css.numbers}>
        <div>
          <Copyable label="Quaternion q_vs: w, x, y, z" text={quaternion} />
          <p className={css.note}>
            Turns sensor readings into vehicle readings, f_v = R(q_vs) f_s. Vehicle axes: x forward, y left, z
            up (ISO 8855).
          </p>
        </div>
        <MatrixTable matrix={shown.matrix} />
      </div>
    </Section>
  );
}

export function MatrixTable({ matrix }: { matrix: Shown["matrix"] }) {
  const rows = ["forward", "left", "up"].map((name, i) => ({ name, values: matrix[i] ?? [] }));
  return (
    <table className={css.matrix}>
      <caption>Matrix R(q_vs)</caption>
      <thead>
        <tr>
          <td />
          {["x", "y", "z"].map((axis) => (
            <th key={axis} scope="col">
              device {axis}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {rows.map(({ name, values }) => (
          <tr key={name}>
            <th scope="row">{name}</th>
            {values.map((value, column) => (
              // biome-ignore lint/suspicious/noArrayIndexKey: a matrix's columns are their places
              <td key={column}>{fixed(value, 4)}</td>
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  );
}
