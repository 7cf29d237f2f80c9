#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Uses the report as its readers do, in Chromium from a disk: matrix, case, rays, explanation, picture viewer, at two
widths, in light and dark. Fails on any error of the console and where a page scrolls sideways.

    browser_test.py REPORTS_TEST [--keep FOLDER]     FOLDER gets the report and screenshots

Exit status 77, which CTest reads as skipped, where Chromium, its driver or Selenium is missing
(.ci/packages-browser.txt)."""
import argparse
import base64
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

kSkipped = 77
kWide, kNarrow = (1280, 900), (390, 844)

try:
    from selenium import webdriver
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    print("skipped: python3-selenium is not installed (.ci/packages-browser.txt)")
    sys.exit(kSkipped)


def start_browser(profile):
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if not browser or not driver:
        print("skipped: chromium or chromium-driver is not installed (.ci/packages-browser.txt)")
        sys.exit(kSkipped)
    options = Options()
    options.binary_location = browser
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(service=Service(driver), options=options)


class Reader:
    """One browser on one report."""

    def __init__(self, driver, folder, shots):
        self.driver, self.folder, self.shots = driver, folder, shots
        self.wait = WebDriverWait(driver, 5, poll_frequency=0.02)

    # ---- Ways to look and to act ----

    def js(self, text, *arguments):
        return self.driver.execute_script(text, *arguments)

    def one(self, selector, root=None):
        return (root or self.driver).find_element(By.CSS_SELECTOR, selector)

    def all(self, selector, root=None):
        return (root or self.driver).find_elements(By.CSS_SELECTOR, selector)

    def visible(self, selector):
        """Texts of the elements that are seen; in one question, as there may be hundreds."""
        return self.js("return [...document.querySelectorAll(arguments[0])].filter(e => e.checkVisibility()).map(e => e.textContent)", selector)

    def until(self, what, true):
        self.wait.until(lambda _: true(), what)

    def click(self, element):
        self.js("arguments[0].scrollIntoView({block: 'center'})", element)
        element.click()

    def press(self, *keys):
        self.driver.switch_to.active_element.send_keys(*keys)

    def set_window(self, size, scheme):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": size[0], "height": size[1], "deviceScaleFactor": 1, "mobile": False})
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                    {"features": [{"name": "prefers-color-scheme", "value": scheme}]})

    def open(self, page="index.html", anchor=""):
        self.driver.get("about:blank")  # a change of the anchor alone loads nothing
        self.driver.get((self.folder / page).as_uri() + anchor)

    def check_page(self, name):
        """What must hold of every page in every state."""
        width, inner = self.js("return [document.documentElement.scrollWidth, innerWidth]")
        assert width <= inner, f"{name}: the page scrolls sideways: {width} pixels in a window of {inner}"
        errors = [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]
        assert not errors, f"{name}: the console has errors: {errors}"
        if self.shots:
            self.driver.save_screenshot(str(self.shots / f"{name}.png"))

    # ---- What readers do ----

    def look(self, name, scheme):
        self.open()
        assert self.one("h1").text.startswith("Failed"), "the first heading is not the verdict"
        color = self.js("return getComputedStyle(document.body).backgroundColor")
        light = sum(int(part) for part in color[4:-1].split(",")) > 3 * 128
        assert light == (scheme == "light"), f"{name}: the background is {color}"
        assert self.one("#changes").is_displayed() and self.one("#matrix").is_displayed()
        self.check_page(name)

    def from_matrix_to_case(self, name):
        cell = self.one("#matrix td.s-failed a")
        anchor = cell.get_attribute("hash")
        self.click(cell)
        case = self.one(f"[id='{anchor[1:]}']")
        self.until("the matrix opens its case", lambda: case.get_attribute("open"))
        assert self.js("return location.hash") == anchor
        assert self.js("return arguments[0].contains(document.activeElement)", case), "the case has no focus"
        top = self.js("return arguments[0].getBoundingClientRect().top", case)
        assert 0 <= top < 600, f"the case is not in the window: its top is at {top}"
        shown = self.js("return [...document.querySelectorAll('.case')].filter(c => !c.hidden).map(c => c.closest('.group').dataset.feature + ' ' + c.dataset.scene)")
        wanted = self.js("return arguments[0].closest('.group').dataset.feature", case) + " " + case.get_attribute("data-scene")
        assert len(shown) == 15 and set(shown) == {wanted}, f"the cell narrows the list to {wanted}: {set(shown)}"
        self.check_page(name)
        return case

    def copy_command(self, case):
        box = self.one(".body > .cmd", case)
        command = self.one("code", box).text
        assert command.startswith("plumbline run "), command
        self.click(self.one(".copy", box))
        self.until("the copy button answers", lambda: self.one(".copy", box).text == "Copied")
        pasted = self.driver.execute_async_script("navigator.clipboard.readText().then(arguments[0], e => arguments[0](String(e)))")
        assert pasted == command, f"copied {pasted!r}, not {command!r}"

    def sort_and_filter(self, case):
        table = self.one(".raytable", case)

        def column(number):
            return [cell.text.split("\n")[0] for cell in self.all(f"tbody td:nth-child({number})", table)]

        headings = self.all("thead th", table)
        # A narrow window shows rows as blocks, without headings: there a key must do.
        names = self.js("return [...arguments[0].querySelectorAll('thead th')].map(h => h.textContent)", table)
        at = names.index("ray") + 1
        heading = headings[at - 1]
        for direction in ("ascending", "descending"):
            if heading.is_displayed():
                self.click(self.one("button", heading))
            else:
                chooser = Select(self.one("select.sort", case))
                chooser.select_by_visible_text(f"ray, {direction}")
            assert heading.get_attribute("aria-sort") == direction, heading.get_attribute("aria-sort")
            numbers = self.js("return [...arguments[0].querySelectorAll('tbody tr')].map(r => Number(r.children[arguments[1]].textContent.replaceAll(',', '')))", table, at - 1)
            assert len(numbers) > 3 and numbers == sorted(numbers, reverse=direction == "descending"), numbers
        before = len(self.all("tbody tr", table))
        box = self.one(".rays input[type=search]", case)
        box.send_keys("tracer_wrong")
        rows = self.all("tbody tr", table)
        assert 0 < len(rows) < before and all("tracer_wrong" in row.text for row in rows), "the filter of rays"
        box.clear()
        box.send_keys("nothing has this")
        assert not self.all("tbody tr", table)
        for _ in range(20):
            box.send_keys(Keys.BACKSPACE)
        assert len(self.all("tbody tr", table)) == before

    def explanation(self, case, name):
        link = next(a for a in self.all(".raytable td a", case) if a.text == "explanation")
        self.click(link)
        self.until("the explanation opens", lambda: "/explanations/" in self.driver.current_url)
        assert self.one("h1").text
        assert self.all("#slice svg *"), "the explanation has no picture"
        self.check_page(name)
        self.driver.back()

    def filter_cases(self):
        self.until("the report is there again", lambda: self.all("#case-tools input"))
        self.click(self.one("#matrix td.s-failed a"))
        whole = self.one(".whole")
        assert whole.is_displayed()
        self.click(whole)
        assert not self.js("return document.querySelectorAll('.case[hidden]').length"), "all cases are shown again"
        box = self.one("#case-tools input")
        self.click(box)
        box.send_keys("hits camera")
        shown = self.visible(".case .name")
        self.click(self.one(".case:not([hidden]) > summary"))
        assert self.js("return location.hash") == "#case-" + shown[0], "the address does not lead to the opened case"
        assert len(shown) == 20 and all(name.startswith("hits.camera.") for name in shown), shown[:5]
        box.clear()
        box.send_keys(" ", Keys.BACKSPACE)
        Select(self.one("#case-tools select")).select_by_visible_text("error")
        shown = self.js("return [...document.querySelectorAll('.case')].filter(c => !c.hidden).map(c => c.className)")
        assert len(shown) == 1 and "s-error" in shown[0], shown

    def viewer(self, name):
        self.open(anchor="#case-hits.camera.balls_3")
        case = self.one("[id='case-hits.camera.balls_3']")
        pictures = self.all(".pictures img", case)
        self.until("pictures are shown", lambda: all(self.js("return arguments[0].complete && arguments[0].naturalWidth > 0", p) for p in pictures[:3]))
        button = next(b for b in self.all(".compare button", case) if b.text == "Compare Tracer and Reference")
        self.click(button)
        dialog = self.one("#viewer")
        assert dialog.is_displayed()
        a, b = self.one(".stage .a"), self.one(".stage .b")
        visible = lambda: (a.is_displayed(), b.is_displayed())

        assert visible() == (True, False)
        self.one("[data-do=flip]").click()
        assert visible() == (False, True), "the flip shows the other picture"
        assert self.one("[data-do=flip]").get_attribute("aria-pressed") == "true"
        self.press("f")
        assert visible() == (True, False), "F flips back"

        self.one("[data-do=slide]").click()
        assert visible() == (True, True)
        clips = lambda: [self.js("return arguments[0].style.clipPath", image) for image in (a, b)]
        before = clips()
        self.one(".split input").send_keys(Keys.ARROW_RIGHT * 5)
        assert clips() != before, "the slider moves the edge"
        self.check_page(name + "-slider")
        self.one("[data-do=slide]").click()

        self.one(".stage").send_keys("0", Keys.ARROW_RIGHT, Keys.ARROW_DOWN)
        assert self.one("#viewer output").text == "x 32, y 25", self.one("#viewer output").text
        scale = lambda: self.js("return new DOMMatrix(arguments[0].style.transform).a", a)
        fitted = scale()
        self.one("[data-do=in]").click()
        self.press("+")
        assert scale() == 4 * fitted, (fitted, scale())
        self.until("values are there", lambda: len(self.all("#viewer .numbers")) == 3)
        self.values_are_those_of_the_files(32, 25)
        self.check_page(name + "-zoom")

        # A click chooses the pixel that is under it.
        self.one("[data-do=fit]").click()
        x, y = self.js("""const image = document.querySelector('.stage .a').getBoundingClientRect();
            const stage = document.querySelector('.stage').getBoundingClientRect();
            const pixel = image.width / 64;
            return [image.left + 24.5 * pixel - stage.left - stage.width / 2, image.top + 19.5 * pixel - stage.top - stage.height / 2]""")
        webdriver.ActionChains(self.driver).move_to_element_with_offset(self.one(".stage"), round(x), round(y)).click().perform()
        assert self.one("#viewer output").text == "x 24, y 19", self.one("#viewer output").text
        self.values_are_those_of_the_files(24, 19)
        self.check_page(name + "-pixel")
        self.press(Keys.ESCAPE)
        assert not dialog.is_displayed()

        # By keys alone, on pictures too large to have values.
        large = next(p for p in pictures if p.get_attribute("alt") == "Hit map")
        self.js("arguments[0].focus()", large)
        self.press(Keys.ENTER)
        assert dialog.is_displayed()
        self.press(Keys.ARROW_LEFT)
        assert "only its colour is known" in self.one("#viewer .values").text
        self.press(Keys.ESCAPE)

    def values_are_those_of_the_files(self, x, y):
        """The table names, to the last bit, what the files hold; and the difference is one."""
        found = {}
        for title in ("tracer", "truth", "difference"):
            text = (self.folder / f"pictures/hits.camera.balls_3.{title}.values.js").read_text()
            file = json.loads(text[len("plumbline_values("):-2])
            n = len(file["channels"])
            found[title] = struct.unpack_from(f"<{n}f", base64.b64decode(file["float32"]), 4 * n * (y * file["width"] + x))
        rows = self.all("#viewer .values tr")
        assert len(rows) == 3
        for row, title in zip(rows, found):
            shown = [span.text.split()[-1] for span in self.all("td.numbers span", row)]
            as_floats = tuple(struct.unpack("<f", struct.pack("<f", float(text)))[0] for text in shown)
            assert as_floats == found[title], (title, shown, found[title])
            assert "linear colour" in row.text
        off = sum(found["tracer"]) / 3 - sum(found["truth"]) / 3
        assert abs(off - found["difference"][0]) <= 4e-7 * sum(map(abs, found["truth"])), (off, found["difference"])

    def printed(self):
        """On paper two pictures stand side by side, and nothing to click is left."""
        self.open(anchor="#case-hits.camera.balls_3")
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        first, second = [p.rect for p in self.all("[id='case-hits.camera.balls_3'] .pictures img")[:2]]
        assert first["y"] == second["y"] and first["x"] + first["width"] <= second["x"], (first, second)
        assert not self.visible("button"), "buttons on paper"
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})

    def without_script(self):
        self.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
        self.open(anchor="#case-hits.camera.balls_3")
        case = self.one("[id='case-hits.camera.balls_3']")
        self.one("summary", case).click()
        assert self.one(".pictures img", case).is_displayed(), "pictures need no script"
        assert not self.all(".compare")
        self.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("reports_test")
    parser.add_argument("--keep", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="plumbline-browser-") as scratch:
        folder = pathlib.Path(arguments.keep or scratch).resolve() / "report"
        folder.mkdir(parents=True, exist_ok=True)
        driver = start_browser(scratch + "/profile")
        try:
            subprocess.run([arguments.reports_test, "html: the example report"], check=True, timeout=60,
                           stdout=subprocess.DEVNULL, env=os.environ | {"PLUMBLINE_EXAMPLE": str(folder)})
            reader = Reader(driver, folder, folder.parent if arguments.keep else None)
            driver.execute_cdp_cmd("Browser.grantPermissions", {"permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"]})
            for width, size in (("wide", kWide), ("narrow", kNarrow)):
                for scheme in ("dark", "light"):
                    reader.set_window(size, scheme)
                    reader.look(f"{width}-{scheme}", scheme)
                case = reader.from_matrix_to_case(f"{width}-case")
                reader.copy_command(case)
                reader.sort_and_filter(case)
                reader.explanation(case, f"{width}-explanation")
                reader.filter_cases()
                reader.viewer(f"{width}-viewer")
            reader.printed()
            reader.without_script()
        finally:
            driver.quit()
    print("the report works at 1280 and 390 pixels, in light and dark")


if __name__ == "__main__":
    main()
