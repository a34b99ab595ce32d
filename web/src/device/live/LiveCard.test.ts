import { MantineProvider } from "@mantine/core";
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { createElement } from "react";
import { renderToString } from "react-dom/server";
import { describe, expect, it } from "vitest";
import { keys } from "../../api/keys";
import type { Role, Stage } from "../../api/types";
import { installation } from "../fixture";
import { LiveCard } from "./LiveCard";

function seenBy(role: Role, stage: Stage): string {
  const client = new QueryClient();
  client.setQueryData(keys.session, { role, name: "x", device_id: null });
  const card = createElement(LiveCard, { installation: installation({ stage }) });
  const styled = createElement(MantineProvider, null, card);
  return renderToString(createElement(QueryClientProvider, { client }, styled));
}

describe("level ground", () => {
  const button = "Vehicle stands on level ground";

  it.each(["installer", "manager", "admin"] as const)("is offered to the role %s", (role) =>
    expect(seenBy(role, "settling")).toContain(button),
  );

  it("is not for a device, and not for a mounting that is confirmed", () => {
    expect(seenBy("device", "settling")).not.toContain(button);
    expect(seenBy("installer", "confirmed")).not.toContain(button);
  });
});
