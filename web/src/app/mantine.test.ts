import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { expect, it } from "vitest";

const SOURCE = join(import.meta.dirname, "..");
const STYLES = join(SOURCE, "../node_modules/@mantine/core/styles");

/** What the page's files import from Mantine. */
function imported(): Set<string> {
  const files = readdirSync(SOURCE, { recursive: true, encoding: "utf-8" }).filter((name) =>
    name.endsWith(".tsx"),
  );
  const texts = files.map((name) => readFileSync(join(SOURCE, name), "utf-8"));
  const lists = texts.flatMap((text) => [...text.matchAll(/import \{([^}]*)\} from "@mantine\/core"/g)]);
  return new Set(lists.flatMap(([, names]) => (names ?? "").split(",").map((name) => name.trim())));
}

it("has the styles of every component of Mantine that is used", () => {
  const there = readFileSync(join(SOURCE, "app/mantine.css"), "utf-8");
  const styled = [...imported()].filter((name) => existsSync(join(STYLES, `${name}.css`)));
  expect(styled).toContain("Button");
  expect(styled.filter((name) => !there.includes(`styles/${name}.css`))).toEqual([]);
});
