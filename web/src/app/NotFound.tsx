import { Anchor } from "@mantine/core";
import { MapPinOff } from "lucide-react";
import { Link } from "wouter";
import { Empty } from "../components/States";

export function NotFound({ what }: { what: string }) {
  return (
    <div className="card">
      <Empty icon={MapPinOff} as="h1" title={`${what} does not exist`}>
        <Anchor component={Link} href="/devices">
          To the list of devices
        </Anchor>
      </Empty>
    </div>
  );
}
