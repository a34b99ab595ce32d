import { lazy, Suspense, useRef } from "react";
import type { AskingProps } from "./AskingDialog";

const AskingDialog = lazy(() => import("./AskingDialog"));

/** A dialog that asks. It comes when it is first opened, and stays so that the focus goes back when it closes. */
export function Asking(props: AskingProps) {
  const wanted = useRef(false);
  wanted.current ||= props.opened;
  if (!wanted.current) return null;
  return (
    <Suspense fallback={null}>
      <AskingDialog {...props} />
    </Suspense>
  );
}
