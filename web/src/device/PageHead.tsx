import { Anchor } from "@mantine/core";
import { ArrowLeft, Printer } from "lucide-react";
import { Link } from "wouter";
import { useMay } from "../api/session";
import type { Installation } from "../api/types";
import { RelativeTime } from "../components/RelativeTime";
import css from "./device.module.css";
import { HeadAction } from "./HeadAction";
import { RefitButton } from "./RefitButton";

interface PageHeadProps {
  name: string;
  vehicle: string | null;
  installation: Installation;
}

export function PageHead({ name, vehicle, installation }: PageHeadProps) {
  const installer = useMay("installer");
  const id = installation.device_id;
  return (
    <header className={css.head}>
      <div>
        {installer && (
          <Anchor component={Link} href="/devices" className={css.back}>
            <ArrowLeft size={18} aria-hidden /> Devices
          </Anchor>
        )}
        <h1>{name}</h1>
        <p className={css.facts}>
          {name !== id && <span>{id}</span>}
          {vehicle && <span>{vehicle}</span>}
          <span>
            {installation.last_data_at ? <LastData at={installation.last_data_at} /> : "No data yet"}
          </span>
        </p>
      </div>
      <div className={css.actions}>
        <HeadAction icon={Printer} label="Print the record" onClick={() => window.print()} />
        {installer && <RefitButton id={id} />}
      </div>
    </header>
  );
}

function LastData({ at }: { at: string }) {
  return (
    <>
      Last data <RelativeTime at={at} />
    </>
  );
}
