import { fixed } from "../../lib/format";
import { describe, goodTo } from "../../lib/words";
import { t } from "../../text";
import { MatrixTable } from "../done/NumbersSection";
import { Drawings } from "../picture/Drawings";
import { quaternionText, type Shown } from "../shown";
import css from "./certificate.module.css";

/** The mounting in words, in drawings and in numbers. */
export function Mounting({ shown }: { shown: Shown }) {
  const words = describe(shown.quaternion);
  return (
    <>
      <h2>{t(shown.mount ? "device.certificate.mounting" : "device.certificate.mounting_so_far")}</h2>
      <p>
        {words.turned} {words.axes} {goodTo(shown.sigma)}
      </p>
      <Drawings quaternion={shown.quaternion} />
      <div className={css.tables}>
        <AnglesTable shown={shown} />
        <MatrixTable matrix={shown.matrix} />
      </div>
      <p className={css.quaternion}>
        {t("device.certificate.quaternion", { quaternion: quaternionText(shown.quaternion) })}
      </p>
    </>
  );
}

function AnglesTable({ shown: { angles, sigma } }: { shown: Shown }) {
  const rows = [
    [t("common.roll"), angles.roll, sigma[0]],
    [t("common.pitch"), angles.pitch, sigma[1]],
    [t("common.yaw"), angles.yaw, sigma[2]],
  ] as const;
  return (
    <table>
      <caption>{t("device.certificate.angles")}</caption>
      <tbody>
        {rows.map(([word, degrees, deviation]) => (
          <tr key={word}>
            <th scope="row">{word}</th>
            <td>{fixed(degrees, 2)}°</td>
            <td>{t("device.sure.plus_minus", { degrees: `${fixed(deviation, 2)}°` })}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
