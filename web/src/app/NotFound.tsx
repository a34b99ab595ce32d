import { Anchor } from "@mantine/core";
import { MapPinOff } from "lucide-react";
import { Link } from "wouter";
import { Empty } from "../components/States";
import { t } from "../text";

/** `title`: what does not exist, a whole sentence. */
export function NotFound({ title }: { title: string }) {
  return (
    <div className="card">
      <Empty icon={MapPinOff} as="h1" title={title}>
        <Anchor component={Link} href="/devices">
          {t("shell.to_devices")}
        </Anchor>
      </Empty>
    </div>
  );
}
