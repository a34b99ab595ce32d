import { Anchor } from "@mantine/core";
import { useInViewport } from "@mantine/hooks";
import { Link } from "wouter";
import { useDevice } from "../api/queries";

/** A device by its name, which is looked up while the link is on the screen; until then, and when it is gone, by its id. */
export function DeviceLink({ id }: { id: string }) {
  const { ref, inViewport } = useInViewport<HTMLSpanElement>();
  const device = useDevice(id, inViewport);
  return (
    <span ref={ref}>
      <Anchor component={Link} href={`/devices/${encodeURIComponent(id)}`} underline="always">
        {device.data?.name ?? id}
      </Anchor>
    </span>
  );
}
