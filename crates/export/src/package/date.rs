//! The time that an FMU carries, if it is to carry one (reproducible-builds.org's convention).

use amontons::Error;

/// A time in UTC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Date {
    pub(super) year: u16,
    pub(super) month: u8,
    pub(super) day: u8,
    pub(super) hour: u8,
    pub(super) minute: u8,
    pub(super) second: u8,
}

impl Date {
    /// The time of `SOURCE_DATE_EPOCH`; `None` where it is not set.
    pub(super) fn from_environment() -> Result<Option<Self>, Error> {
        let Some(value) = std::env::var_os("SOURCE_DATE_EPOCH") else { return Ok(None) };
        let seconds = value.to_str().and_then(|text| text.parse().ok());
        seconds.and_then(Self::from_unix_time).map(Some).ok_or_else(|| {
            Error::package(format!(
                "SOURCE_DATE_EPOCH = {}: must be the seconds since 1970 of a time between 1980 and \
                 2107, which archives can hold",
                value.display()
            ))
        })
    }

    /// Civil date from days, after Howard Hinnant's `civil_from_days`.
    fn from_unix_time(seconds: u64) -> Option<Self> {
        let (days, second_of_day) = (seconds / 86_400, seconds % 86_400);
        let shifted = days + 719_468;
        let (era, day_of_era) = (shifted / 146_097, shifted % 146_097);
        let year_of_era =
            (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
        let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
        let from_march = (5 * day_of_year + 2) / 153;
        let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
        let year = year_of_era + 400 * era + u64::from(month <= 2);
        (1980..=2107).contains(&year).then_some(())?;
        Some(Self {
            year: u16::try_from(year).ok()?,
            month: u8::try_from(month).ok()?,
            day: u8::try_from(day_of_year - (153 * from_march + 2) / 5 + 1).ok()?,
            hour: u8::try_from(second_of_day / 3600).ok()?,
            minute: u8::try_from(second_of_day / 60 % 60).ok()?,
            second: u8::try_from(second_of_day % 60).ok()?,
        })
    }
}

/// As XML Schema writes it: `2026-11-20T09:30:00Z`.
impl std::fmt::Display for Date {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { year, month, day, hour, minute, second } = self;
        write!(f, "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_become_the_date_that_the_calendar_has() {
        let date = |seconds| Date::from_unix_time(seconds).unwrap().to_string();
        // From the table of POSIX and from leap days.
        assert_eq!(date(1_000_000_000), "2001-09-09T01:46:40Z");
        assert_eq!(date(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(date(1_709_251_199), "2024-02-29T23:59:59Z");
        assert_eq!(date(315_532_800), "1980-01-01T00:00:00Z");
    }

    #[test]
    fn what_an_archive_cannot_hold_is_refused() {
        assert_eq!(Date::from_unix_time(315_532_799), None);
        assert_eq!(Date::from_unix_time(u64::MAX), None);
    }
}
