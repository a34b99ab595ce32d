import { Button } from "@mantine/core";
import { Search, Truck } from "lucide-react";
import { Empty } from "../components/States";

interface NoDevicesProps {
  filtered: boolean;
  onClear: () => void;
  onRegister: (() => void) | undefined;
}

export function NoDevices({ filtered, onClear, onRegister }: NoDevicesProps) {
  if (filtered) {
    return (
      <div className="card" role="status">
        <Empty icon={Search} title="No device matches">
          <Button variant="default" onClick={onClear}>
            Show all devices
          </Button>
        </Empty>
      </div>
    );
  }
  return (
    <div className="card">
      <Empty icon={Truck} title="No devices yet">
        <p>
          Register the first one: it gets a key of its own, sends what it measures, and this page shows how it
          is mounted.
        </p>
        {onRegister && <Button onClick={onRegister}>Register a device</Button>}
      </Empty>
    </div>
  );
}
