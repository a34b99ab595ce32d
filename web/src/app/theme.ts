import { type CSSVariablesResolver, createTheme, type MantineColorsTuple } from "@mantine/core";

const petrol: MantineColorsTuple = [
  "#e6f5fa",
  "#cfe8f1",
  "#9fd0e2",
  "#6cb8d3",
  "#46a4c7",
  "#2f98bf",
  "#1c88b0",
  "#127da4",
  "#0b6e93",
  "#055a79",
];

/** The grounds and lines of the dark scheme, with a little of the accent's blue in them. */
const dark: MantineColorsTuple = [
  "#e6edf2",
  "#c5d0d9",
  "#a3b1bd",
  "#74858f",
  "#3a4955",
  "#2b3843",
  "#212c35",
  "#182129",
  "#121a20",
  "#0c1216",
];

/** One accent colour; large touch targets; the reader's own system font, so that nothing is fetched. */
export const theme = createTheme({
  primaryColor: "petrol",
  primaryShade: { light: 8, dark: 8 },
  colors: { petrol, dark },
  defaultRadius: "md",
  fontFamily: "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', 'Liberation Sans', sans-serif",
  fontFamilyMonospace: "ui-monospace, 'SF Mono', 'Roboto Mono', 'Liberation Mono', monospace",
  headings: { fontWeight: "650" },
  cursorType: "pointer",
  respectReducedMotion: true,
  components: {
    Button: { defaultProps: { size: "md" } },
    ActionIcon: { defaultProps: { size: 44, variant: "subtle" } },
    TextInput: { defaultProps: { size: "md" } },
    Textarea: { defaultProps: { size: "md" } },
    PasswordInput: { defaultProps: { size: "md" } },
    // lockScroll would write a <style>; base.css does the same. A dialog's header is no banner of the page.
    Modal: {
      defaultProps: {
        lockScroll: false,
        attributes: { header: { role: "presentation" } },
        centered: true,
        radius: "lg",
        closeButtonProps: { "aria-label": "Close" },
      },
    },
  },
});

/**
 * The page's own colours, each at least 4.5:1 on its ground. Roll, pitch and yaw keep the colour of the vehicle axis they
 * turn about, in the charts, the numbers and the picture.
 */
export const colours: CSSVariablesResolver = () => ({
  variables: {},
  light: {
    "--mantine-color-body": "#f4f7f9",
    "--mantine-color-text": "#16212b",
    "--mantine-color-dimmed": "#4d5b68",
    "--mantine-color-placeholder": "#66737f",
    "--mantine-color-anchor": "#0b6e93",
    "--livella-card": "#ffffff",
    "--livella-line": "#dbe3e9",
    "--livella-sunken": "#eaf0f4",
    "--livella-accent": "#0b6e93",
    "--livella-accent-soft": "#dff0f6",
    "--livella-good": "#1d6f3a",
    "--livella-good-soft": "#e0f3e6",
    "--livella-warn": "#8f4a00",
    "--livella-warn-soft": "#fdeed8",
    "--livella-bad": "#b3261e",
    "--livella-bad-soft": "#fde5e3",
    "--livella-x": "#b8340a",
    "--livella-y": "#1d7a3f",
    "--livella-z": "#2456d6",
    "--livella-car": "#8fa3b3",
    "--livella-tyre": "#3c4954",
  },
  dark: {
    "--mantine-color-body": "#0f151a",
    "--mantine-color-text": "#e6edf2",
    "--mantine-color-dimmed": "#a3b1bd",
    "--mantine-color-placeholder": "#8b9aa7",
    "--mantine-color-anchor": "#6cc4e2",
    "--livella-card": "#182129",
    "--livella-line": "#2b3843",
    "--livella-sunken": "#212c35",
    "--livella-accent": "#6cc4e2",
    "--livella-accent-soft": "#143644",
    "--livella-good": "#6fd492",
    "--livella-good-soft": "#153524",
    "--livella-warn": "#f2b35c",
    "--livella-warn-soft": "#3b2a10",
    "--livella-bad": "#ff9c94",
    "--livella-bad-soft": "#44201d",
    "--livella-x": "#ff9a70",
    "--livella-y": "#66cf8b",
    "--livella-z": "#8fb0ff",
    "--livella-car": "#8ba0b0",
    "--livella-tyre": "#0a0f13",
  },
});
