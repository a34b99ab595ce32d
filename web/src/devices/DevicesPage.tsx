import { Button } from "@mantine/core";
import { Plus } from "lucide-react";
import { lazy, Suspense, useRef, useState } from "react";
import { useSummary } from "../api/queries";
import { useTitle } from "../app/title";
import { t } from "../text";
import css from "./devices.module.css";
import { FirstSteps } from "./FirstSteps";
import { Fleet } from "./Fleet";
import { Tiles } from "./Tiles";
import { useFilter } from "./useFilter";

const loadAddDevice = () => import("./add/AddDevice");
const AddDevice = lazy(loadAddDevice);

/** The fleet: who is calibrated, who is under way, who needs a hand. */
export function DevicesPage() {
  useTitle(t("devices.title"));
  const [filter, change] = useFilter();
  const { data: summary } = useSummary();
  const adding = useDialog();
  const hasNone = summary?.devices === 0;
  return (
    <>
      <header className={css.head}>
        <h1>{t("devices.title")}</h1>
        <Button
          ref={adding.fallback}
          leftSection={<Plus size={20} aria-hidden />}
          onClick={adding.open}
          onPointerEnter={loadAddDevice}
          onFocus={loadAddDevice}
        >
          {t("devices.add")}
        </Button>
      </header>
      {hasNone ? (
        <FirstSteps onAdd={adding.open} />
      ) : (
        <>
          <Tiles filter={filter} onChange={change} summary={summary} />
          <Fleet filter={filter} onChange={change} summary={summary} />
        </>
      )}
      {adding.opened && (
        <Suspense>
          <AddDevice onClose={adding.close} />
        </Suspense>
      )}
    </>
  );
}

/** A dialog that begins anew each time, and gives the focus back to what opened it, or else to the fallback. */
function useDialog() {
  const [opened, setOpened] = useState(false);
  const opener = useRef<Element>(null);
  const fallback = useRef<HTMLButtonElement>(null);
  const open = () => {
    opener.current = document.activeElement;
    setOpened(true);
  };
  const close = () => {
    setOpened(false);
    const { current } = opener;
    if (current instanceof HTMLElement && current.isConnected) current.focus();
    else fallback.current?.focus();
  };
  return { opened, open, close, fallback };
}
