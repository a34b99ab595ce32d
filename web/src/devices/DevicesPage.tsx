import { Button, TextInput } from "@mantine/core";
import { useDebouncedValue, useDisclosure, useDocumentTitle } from "@mantine/hooks";
import { Plus, Search } from "lucide-react";
import { useState } from "react";
import type { DeviceFilter } from "../api/keys";
import { useDevices, useSummary } from "../api/queries";
import { useMay } from "../api/session";
import type { Device } from "../api/types";
import { Failed, Loading } from "../components/States";
import { DeviceList } from "./DeviceList";
import css from "./devices.module.css";
import { NoDevices } from "./NoDevices";
import { RegisterDialog } from "./RegisterDialog";
import { StageFilter } from "./StageFilter";

const EVERYTHING: DeviceFilter = { q: "", stage: "", hasOpenAlert: false };

/** The fleet: who is calibrated, who is under way, who needs a hand. */
export function DevicesPage() {
  useDocumentTitle("Devices · Livella");
  const [filter, setFilter] = useState(EVERYTHING);
  const [registering, dialog] = useDisclosure(false);
  const mayRegister = useMay("installer");
  const summary = useSummary();
  return (
    <>
      <header className={css.head}>
        <h1>Devices</h1>
        {mayRegister && (
          <Button leftSection={<Plus size={20} aria-hidden />} onClick={dialog.open}>
            Register a device
          </Button>
        )}
      </header>
      <div className={css.filters}>
        <TextInput
          type="search"
          aria-label="Search by name, id or vehicle"
          placeholder="Name, id or vehicle"
          leftSection={<Search size={18} aria-hidden />}
          value={filter.q}
          onChange={(event) => setFilter({ ...filter, q: event.currentTarget.value })}
        />
        <StageFilter filter={filter} onChange={setFilter} summary={summary.data} />
      </div>
      <Results
        filter={filter}
        onClear={() => setFilter(EVERYTHING)}
        onRegister={mayRegister ? dialog.open : undefined}
      />
      <RegisterDialog opened={registering} onClose={dialog.close} />
    </>
  );
}

interface ResultsProps {
  filter: DeviceFilter;
  onClear: () => void;
  onRegister: (() => void) | undefined;
}

function Results({ filter, onClear, onRegister }: ResultsProps) {
  const [q] = useDebouncedValue(filter.q.trim(), 250);
  const wanted = { ...filter, q };
  const list = useDevices(wanted);
  if (list.isPending) return <Loading what="the devices" lines={8} />;
  if (list.isError) return <Failed what="the devices" error={list.error} retry={list.refetch} />;
  const devices: Device[] = list.data.pages.flatMap((page) => page.items);
  const filtered = wanted.q !== "" || wanted.stage !== "" || wanted.hasOpenAlert;
  if (devices.length === 0)
    return <NoDevices filtered={filtered} onClear={onClear} onRegister={onRegister} />;
  return (
    <>
      <DeviceList devices={devices} stale={list.isPlaceholderData} />
      {list.hasNextPage && (
        <Button
          mt="md"
          variant="default"
          loading={list.isFetchingNextPage}
          onClick={() => list.fetchNextPage()}
        >
          Show more
        </Button>
      )}
    </>
  );
}
