import { lazy, Suspense } from "react";
import type { DialogProps } from "./DialogWindow";

/** What traps the focus and holds the page still comes when the first dialog is opened. */
const DialogWindow = lazy(() => import("./DialogWindow").then((m) => ({ default: m.DialogWindow })));

/** A dialog, open while it is rendered: in the middle of a desk's screen, all over a phone's. */
export function Dialog(props: DialogProps) {
  return (
    <Suspense fallback={null}>
      <DialogWindow {...props} />
    </Suspense>
  );
}
