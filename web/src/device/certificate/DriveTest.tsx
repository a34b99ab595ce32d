import type { Verification } from "../../api/types";
import { fixed } from "../../lib/format";
import { t } from "../../text";
import { kmh, speeds } from "../verification/trace";
import { SpeedDrawing } from "./SpeedDrawing";

/** What the mounting was tested with; null where none is confirmed. */
export function DriveTest({ test }: { test: Verification | null }) {
  const drawn = test && speeds(test.trace);
  return (
    <section>
      <h2>{t("device.certificate.test")}</h2>
      <p>{sentence(test)}</p>
      {drawn && <SpeedDrawing speeds={drawn} />}
    </section>
  );
}

function sentence(test: Verification | null): string {
  if (test?.error_mps == null) return t("device.certificate.no_test");
  return t("device.certificate.test_passed", {
    seconds: fixed(test.elapsed_s, 0),
    error: kmh(test.error_mps),
    limit: kmh(test.limit_mps),
  });
}
