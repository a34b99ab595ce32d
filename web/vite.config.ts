import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import {
  convertCssVariables,
  DEFAULT_THEME,
  defaultCssVariablesResolver,
  type MantineTheme,
  mergeMantineTheme,
} from "@mantine/core";
import react from "@vitejs/plugin-react";
import type { Plugin } from "vite";
import { compression } from "vite-plugin-compression2";
import { defineConfig } from "vitest/config";
import { colours, theme } from "./src/app/theme.ts";

const SWAGGER_FILES = ["swagger-ui.css", "swagger-ui-bundle.js", "favicon-32x32.png"];

/** Puts the files of the service's /docs page beside the page, so that it too needs no network. */
function swagger(): Plugin {
  const { resolve } = createRequire(import.meta.url);
  return {
    name: "livella-swagger",
    apply: "build",
    generateBundle() {
      for (const name of SWAGGER_FILES) {
        const source = readFileSync(resolve(`swagger-ui-dist/${name}`));
        this.emitFile({ type: "asset", fileName: `swagger/${name}`, source });
      }
    },
  };
}

const THEME_CSS = "virtual:theme.css";

/**
 * Writes the theme's variables into a style sheet. Mantine would put them into a <style> of the document, which the
 * service's content security policy forbids.
 */
function themeVariables(): Plugin {
  return {
    name: "livella-theme",
    resolveId: (id) => (id === THEME_CSS ? `\0${THEME_CSS}` : null),
    load: (id) => (id === `\0${THEME_CSS}` ? themeCss(mergeMantineTheme(DEFAULT_THEME, theme)) : null),
  };
}

function themeCss(merged: MantineTheme): string {
  const scheme = (name: string) => ({ "--mantine-color-scheme": name });
  return [
    convertCssVariables(defaultCssVariablesResolver(merged)),
    convertCssVariables({ variables: {}, light: scheme("light"), dark: scheme("dark") }),
    convertCssVariables(colours(merged)),
  ].join("\n");
}

export default defineConfig({
  plugins: [
    react(),
    themeVariables(),
    swagger(),
    // beside each file, so that the service need not compress it for every visit
    compression({ algorithms: ["gzip", "brotliCompress"], include: /\.(css|js|svg|html)$/ }),
  ],
  build: {
    outDir: "../api/static",
    emptyOutDir: true,
    target: "es2022",
    // Everything is a file of its own: the service's content security policy allows no data: scripts or fonts.
    assetsInlineLimit: 0,
    rolldownOptions: {
      // What many parts share comes as one file, because a phone's network takes long to begin each; charts and dialogs come later.
      output: {
        codeSplitting: {
          groups: [
            {
              name: "shared",
              minShareCount: 4,
              test: /^(?!.*(uplot|Modal|remove-scroll|FocusTrap|ScrollArea))/i,
            },
          ],
        },
      },
    },
    // three.js, loaded only where the picture is shown.
    chunkSizeWarningLimit: 800,
  },
  server: { proxy: { "/api": "http://127.0.0.1:8000" } },
  test: { environment: "node", include: ["src/**/*.test.ts"], setupFiles: ["src/text/setup.ts"] },
});
