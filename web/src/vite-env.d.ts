import "react";

declare module "virtual:theme.css";

/** Custom properties in `style`. */
declare module "react" {
  interface CSSProperties {
    [name: `--${string}`]: string | number;
  }
}
