import { MantineProvider } from "@mantine/core";
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { createElement } from "react";
import { renderToString } from "react-dom/server";
import { describe, expect, it } from "vitest";
import { keys } from "../api/keys";
import type { Installation, Role, Stage } from "../api/types";
import { StageSection } from "./StageSection";

const installation = (stage: Stage): Installation => ({
  device_id: "a",
  stage,
  since: "2025-11-22T10:00:00Z",
  progress: 0.5,
  needs: ["turn"],
  hint: "Take a few turns.",
  estimate: null,
  verification: { state: "idle", elapsed_s: 0, duration_s: 40, error_mps: null, limit_mps: 2.5, trace: null },
  mount: null,
  limits: { yaw_sigma_deg: 1.5, tilt_sigma_deg: 1.3 },
  open_alerts: 0,
  last_data_at: "2025-11-22T10:01:00Z",
  data: null,
  revision: 7,
});

function seenBy(role: Role, stage: Stage): string {
  const client = new QueryClient();
  client.setQueryData(keys.session, { role, name: "x", device_id: null });
  const section = createElement(StageSection, { installation: installation(stage) });
  const styled = createElement(MantineProvider, null, section);
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
