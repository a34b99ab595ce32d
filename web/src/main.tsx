import "./app/mantine.css";
import "virtual:theme.css";
import "./app/base.css";
import { createRoot } from "react-dom/client";
import { App } from "./app/App";
import { askEarly } from "./app/early";
import { comesTo } from "./app/pages";
import { startText } from "./text";

const root = document.getElementById("root");
if (root) {
  askEarly(location);
  startText().then(() => {
    comesTo(location.pathname);
    createRoot(root).render(<App />);
  });
}
