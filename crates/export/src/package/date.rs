//! The time that an FMU carries, if it is to carry one (reproducible-builds.org's convention).

use amontons::Error;
use time::OffsetDateTime;
use zip::DateTime;

/// A time in UTC.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Date {
    /// The time in the notation of XML Schema: `2026-11-20T09:30:00Z`.
    pub(super) text: String,
    pub(super) in_archive: DateTime,
}

impl Date {
    /// The time of `SOURCE_DATE_EPOCH`; `None` where it is not set.
    pub(super) fn from_environment() -> Result<Option<Self>, Error> {
        let Some(value) = std::env::var_os("SOURCE_DATE_EPOCH") else { return Ok(None) };
        let seconds = value.to_str().and_then(|text| text.parse().ok());
        seconds.and_then(Self::from_unix_time).map(Some).ok_or_else(|| {
            Error::package(format!(
                "SOURCE_DATE_EPOCH = {}: must be a time in seconds since 1970, between the years 1980 and 2107, the \
                 range of zip archives",
                value.display()
            ))
        })
    }

    fn from_unix_time(seconds: i64) -> Option<Self> {
        let date = OffsetDateTime::from_unix_timestamp(seconds).ok()?;
        let (hour, minute, second) = date.to_hms();
        let (year, month) = (date.year().try_into().ok()?, date.month().into());
        let in_archive =
            DateTime::from_date_and_time(year, month, date.day(), hour, minute, second).ok()?;
        let text = format!("{}T{hour:02}:{minute:02}:{second:02}Z", date.date());
        Some(Self { text, in_archive })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_become_the_date_that_the_calendar_has() {
        let date = |seconds| Date::from_unix_time(seconds).unwrap().text;
        // From the table of POSIX and from leap days.
        assert_eq!(date(1_000_000_000), "2001-09-09T01:46:40Z");
        assert_eq!(date(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(date(1_709_251_199), "2024-02-29T23:59:59Z");
        assert_eq!(date(315_532_800), "1980-01-01T00:00:00Z");
    }

    #[test]
    fn what_an_archive_cannot_hold_is_refused() {
        assert_eq!(Date::from_unix_time(315_532_799), None);
        assert_eq!(Date::from_unix_time(i64::MAX), None);
    }
}
